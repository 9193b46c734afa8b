#include "engine/normals/normal_errors.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "engine/normals/exact.hpp"
#include "engine/normals/normal_method.hpp"
#include "tests/support/normal_errors.hpp"

namespace sulcus::normal_errors_test {
namespace {

TEST(NormalErrors, AreTheAnglesToTheExactNormalsAtTheSurfaceAlone) {
  const Workpiece workpiece(test::two_balls());
  NormalSettings settings;
  settings.normals = NormalMethod::kWeightedSum;
  const VoxelValues errors = normal_errors(workpiece, settings);
  const std::vector<Cell> cells = test::surface_cells(workpiece);
  double largest_deg = 0.0;
  for (std::size_t k = 0; k < cells.size(); k += 7) {
    const SurfaceEstimate felt = estimate_surface(workpiece, cells[k], settings);
    const SurfaceEstimate exact = estimate_exact(workpiece, cells[k], settings.neighbourhood);
    if (!felt.defined || !exact.defined) {
      EXPECT_TRUE(std::isnan(errors.at(cells[k])));
      continue;
    }
    const double deg = test::angle_deg(felt.normal.cast<double>(), exact.normal.cast<double>());
    EXPECT_NEAR(errors.at(cells[k]) / kDegree, deg, 1e-3);
    largest_deg = std::max(largest_deg, deg);
  }
  EXPECT_GT(largest_deg, 2.0);
  std::size_t with_value = 0;
  for (const auto& [leaf, block] : errors.blocks()) {
    with_value += std::ranges::count_if(block, [](float v) { return !std::isnan(v); });
  }
  EXPECT_LE(with_value, cells.size());
  EXPECT_GT(with_value, cells.size() / 2);

  settings.normals = NormalMethod::kExact;
  const VoxelValues none = normal_errors(workpiece, settings);
  for (const auto& [leaf, block] : none.blocks()) {
    for (const float value : block) EXPECT_FALSE(value > 1e-6f);
  }
}

}  // namespace
}  // namespace sulcus::normal_errors_test
