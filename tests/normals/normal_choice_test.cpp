#include "engine/normals/normal_choice.hpp"

#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/normals/normal_method.hpp"
#include "tests/support/normal_errors.hpp"

namespace sulcus {
namespace {

using Eigen::Vector3d;

HapticsSettings haptics_of(const NormalChoice& choice) {
  HapticsSettings settings;
  settings.normals = choice.method;
  settings.neighbourhood = choice.neighbourhood;
  settings.trace = choice.trace;
  return settings;
}

bool same(const NormalChoice& a, const NormalChoice& b) {
  return a.method == b.method && a.neighbourhood == b.neighbourhood && a.trace == b.trace;
}

TEST(NormalChoice, DifferentErrorsPickDifferentSettings) {
  const auto fine = choose_normals(1.5), middle = choose_normals(2.5), coarse = choose_normals(4.0);
  ASSERT_TRUE(fine && middle && coarse);
  EXPECT_FALSE(same(*fine, *middle));
  EXPECT_FALSE(same(*middle, *coarse));
  EXPECT_FALSE(same(*fine, *coarse));
}

TEST(NormalChoice, WhatIsPickedPromisesWhatWasAsked) {
  std::optional<NormalChoice> last;
  for (double error = 0.5; error < 90.0; error += 0.05) {
    const auto choice = choose_normals(error);
    if (!choice) {
      EXPECT_LT(error, most_accurate_normals().error_deg);
      continue;
    }
    EXPECT_LE(choice->error_deg, error);
    // Asking for less never gets more.
    if (last) {
      EXPECT_GE(choice->error_deg, last->error_deg);
    }
    last = choice;
  }
  ASSERT_TRUE(last);
  EXPECT_EQ(last->neighbourhood, 1) << "the cheapest, where anything will do";
}

TEST(NormalChoice, TheBestIsPickedAtItsOwnErrorAndNothingBelow) {
  const NormalChoice best = most_accurate_normals();
  const auto at = choose_normals(best.error_deg);
  ASSERT_TRUE(at);
  EXPECT_TRUE(same(*at, best));
  EXPECT_FALSE(choose_normals(best.error_deg - 1e-6));
  EXPECT_FALSE(choose_normals(0.0));
}

// A rod aslant, curved one way only: not among the shapes that the table was made from.
TEST(NormalChoice, ItIsMetOnAnotherShape) {
  const Vector3d axis = Vector3d(0.5, -0.3, 0.7).normalized(), through(39.6, 40.2, 39.9);
  const double radius = 16.0;
  const auto from_axis = [&](const Cell& c) -> Vector3d {
    const Vector3d p = c.cast<double>() - through;
    return p - p.dot(axis) * axis;
  };
  const Workpiece rod(test::make_model(
      {80, 80, 80}, 1e-4, [&](const Cell& c) { return from_axis(c).norm() <= radius; }));
  std::vector<Cell> cells = test::inner_surface(rod, 16);
  ASSERT_GT(cells.size(), 2000u);
  double last = 0.0;
  for (const double error : {1.5, 2.5, 4.0}) {
    const HapticsSettings settings = haptics_of(*choose_normals(error));
    const test::NormalErrors found = test::measure_errors(
        cells, [&](const Cell& c) { return estimate_surface(rod, c, settings); },
        [&](const Cell& c) {
          return test::SurfaceTruth{from_axis(c).normalized(), radius - from_axis(c).norm()};
        });
    EXPECT_EQ(found.undefined, 0);
    EXPECT_LE(found.mean_deg, error);
    EXPECT_GT(found.mean_deg, last) << "no more accurate than it need be";
    last = found.mean_deg;
  }
}

}  // namespace
}  // namespace sulcus
