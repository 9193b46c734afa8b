#include "engine/normals/quadric_filter.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::quadric_filter_test {
namespace {

TEST(ColumnQuadric, AQuadricAslantIsRecoveredFromItsHeights) {
  // Heights of a cap of 30 voxels' radius about 35 degrees from the axis, without quantisation:
  // what the filter alone makes of them is off by degrees at the rim's scale, the correction is
  // not.
  const double radius = 30.0, tilt = 0.6;
  const QuadricFilter& filter = quadric_filter(6, 16);
  // Heights in 1/256 voxel, so that their sums are whole numbers.
  constexpr double kFine = 256.0;
  QuadricSums sums{};
  for (std::size_t f = 0; f < kQuadric; ++f) {
    for (int j = -6; j <= 6; ++j) {
      for (int i = -6; i <= 6; ++i) {
        const double x = i + radius * std::sin(tilt);
        const double z = std::sqrt(radius * radius - x * x - j * j) - radius * std::cos(tilt);
        sums[f] +=
            static_cast<int>(std::lround(kFine * z)) * filter.coefficient[f][(6 + j) * 16 + 8 + i];
      }
    }
  }
  Quadric fitted = quadric_of(sums, 0, 0, 1, filter.solution);
  fitted[0] -= 0.5f;  // which a whole voxel's height has and these do not
  for (float& c : fitted) c /= static_cast<float>(kFine);
  const Eigen::Vector3d truth(std::sin(tilt), 0.0, std::cos(tilt));
  ColumnQuadric plain;
  plain.c = fitted;
  const auto error_deg = [&](const ClosestPoint& closest) {
    return test::angle_deg({closest.normal_x, closest.normal_y, closest.normal_z}, truth);
  };
  const double before = error_deg(closest_point_of(plain));
  const double after = error_deg(closest_point_of(column_quadric(fitted, filter.answers, 1.0f)));
  EXPECT_GT(before, 0.8);
  EXPECT_LT(after, 0.2);
}

TEST(QuadricFilter, GivesTheCoefficientsOfEveryQuadric) {
  for (const int rings : {2, 3, 6, 7, 12}) {
    const QuadricFilter& filter = quadric_filter(rings, lanes_of(rings));
    for (std::size_t term = 0; term < kQuadric; ++term) {
      QuadricSums sums{};
      for (int j = -rings; j <= rings; ++j) {
        for (int i = -rings; i <= rings; ++i) {
          const int power[kQuadric] = {1, i, j, i * i, i * j, j * j};
          for (std::size_t f = 0; f < kQuadric; ++f) {
            sums[f] += power[term] *
                       filter.coefficient[f][(rings + j) * filter.lanes + filter.lanes / 2 + i];
          }
        }
      }
      const int centre = term == 0;
      const Quadric c = quadric_of(sums, centre, centre, 1, filter.solution);
      for (std::size_t f = 0; f < kQuadric; ++f) {
        EXPECT_NEAR(c[f], (f == term) + (f == 0 ? 0.5f : 0.0f), 2e-5f)
            << rings << " " << f << " " << term;
      }
    }
  }
}

}  // namespace
}  // namespace sulcus::quadric_filter_test
