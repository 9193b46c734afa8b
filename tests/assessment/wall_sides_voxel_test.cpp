// Walls that lean by another angle on each side, in voxels that stand otherwise to them.
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/assessment/preparation_shape.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "tests/assessment/lofted_solid.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::wall_sides_voxel_test {
namespace {

using test::raised;
using test::Rectangle;
using test::Tapers;

constexpr double kVoxel_mm = 0.05;
constexpr Tapers kTapers{3.0, 8.0, -3.0, 5.0};

bool holds(const Rectangle& r, const Eigen::Vector3d& p_mm) {
  return p_mm.x() > r.distal && p_mm.x() < r.mesial && p_mm.y() > r.buccal && p_mm.y() < r.lingual;
}

/// A block of 7.2 x 6.2 x 6 mm; with a cavity of 2 mm in its upper face.
bool is_solid(const Eigen::Vector3d& p_mm, bool cut) {
  if (std::abs(p_mm.z()) > 3.0 || !holds({-3.6, 3.6, -3.1, 3.1, 0.0}, p_mm)) return false;
  const Rectangle floor{-1.513, 1.327, -1.089, 0.927, 1.0};
  return !cut || p_mm.z() < floor.z || !holds(raised(floor, p_mm.z() - floor.z, kTapers), p_mm);
}

TriangleMesh surface(const Eigen::Affine3d& placed, bool cut) {
  const Eigen::Affine3d back = placed.inverse();
  const VoxelGrid grid{Eigen::Vector3i::Constant(216), 1e-3 * kVoxel_mm};
  return closed_surface(test::make_model(grid.cells, grid.voxel_m, [&](const Cell& c) {
    return is_solid(back * (1e3 * grid.centre_world(c)), cut);
  }));
}

TEST(WallSidesOfVoxels, HaveEachItsTaper) {
  struct Attitude {
    double degrees;
    Eigen::Vector3d axis;
    double within_deg;
  };
  for (const Attitude& at : {Attitude{0, {0, 0, 1}, 2.0}, Attitude{25, {0, 0, 1}, 0.5},
                             Attitude{33, {1, 2, 0.5}, 0.5}, Attitude{160, {1, -0.4, 0.3}, 0.5}}) {
    const Eigen::Affine3d placed(
        Eigen::AngleAxisd(at.degrees * std::numbers::pi / 180.0, at.axis.normalized()));
    const auto found = preparation_shape(surface(placed, false), surface(placed, true),
                                         {.insertion = placed.linear().col(2),
                                          .mesial = placed.linear().col(0),
                                          .buccal = -placed.linear().col(1)});
    ASSERT_TRUE(found);
    const std::array expected{kTapers.mesial, kTapers.distal, kTapers.buccal, kTapers.lingual};
    for (std::size_t side = 0; side < expected.size(); ++side) {
      SCOPED_TRACE("turned by " + std::to_string(at.degrees) + ", side " + std::to_string(side));
      ASSERT_TRUE(found->wall_deg[side]);
      EXPECT_NEAR(found->wall_deg[side]->value, expected[side], at.within_deg);
    }
  }
}

}  // namespace
}  // namespace sulcus::wall_sides_voxel_test
