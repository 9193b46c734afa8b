// Walls along the grid, whose voxels know least of how they lean: a slot in a block, as bits and as
// fractions. Roughness and the wall that is left, of meshes whose figures can be written down.
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/assessment/preparation_shape.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "engine/volume/voxel_model.hpp"
#include "tests/assessment/turned_solid.hpp"

namespace sulcus::flat_walls_test {
namespace {

constexpr double kVoxel_mm = 0.05;

double tan_deg(double degrees) { return std::tan(degrees * std::numbers::pi / 180.0); }

/// A block of 5.2 x 5.2 x 4 mm with a slot of 1.2 x 3 mm at its floor, 3 mm deep, its walls leaning
/// out by `taper_deg`, each of them otherwise to the voxels; none below 0.
bool is_solid(const Eigen::Vector3d& p_mm, double taper_deg) {
  if (std::abs(p_mm.x()) > 2.6 || std::abs(p_mm.y()) > 2.6 || std::abs(p_mm.z()) > 2.0) {
    return false;
  }
  const double wider = (p_mm.z() + 0.987) * tan_deg(taper_deg);
  return taper_deg < 0.0 || p_mm.z() < -0.987 || p_mm.y() > 1.513 + wider ||
         p_mm.y() < -1.5 - wider || p_mm.x() > 0.627 + wider || p_mm.x() < -0.589 - wider;
}

VoxelGrid grid() { return {Eigen::Vector3i(112, 112, 88), 1e-3 * kVoxel_mm}; }

VoxelModel bits(double taper_deg) {
  const VoxelGrid in = grid();
  return test::make_model(in.cells, in.voxel_m, [&](const Cell& c) {
    return is_solid(1e3 * in.centre_world(c), taper_deg);
  });
}

/// What of each voxel is filled, by 6^3 samples of it.
VoxelModel fractions(double taper_deg) {
  constexpr int kSamples = 6;
  const VoxelGrid in = grid();
  const auto level = [&](const Cell& c) -> int {
    // Where all corners are alike the voxel is whole.
    int corners = 0;
    for_each_cell(Cell::Zero(), Cell::Constant(2), [&](const Cell& s) {
      const Eigen::Vector3d off = s.cast<double>() - Eigen::Vector3d::Constant(0.5);
      corners += is_solid(1e3 * in.world_from_index(c.cast<double>() + off), taper_deg) ? 1 : 0;
    });
    if (corners == 0 || corners == 8) return corners == 0 ? 0 : kFullLevel;
    int inside = 0;
    for_each_cell(Cell::Zero(), Cell::Constant(kSamples), [&](const Cell& s) {
      const Eigen::Vector3d off =
          (s.cast<double>().array() + 0.5).matrix() / kSamples - Eigen::Vector3d::Constant(0.5);
      inside += is_solid(1e3 * in.world_from_index(c.cast<double>() + off), taper_deg) ? 1 : 0;
    });
    return (inside * kFullLevel + kSamples * kSamples * kSamples / 2) /
           (kSamples * kSamples * kSamples);
  };
  VoxelModel model =
      test::make_model(in.cells, in.voxel_m, [&](const Cell& c) { return level(c) > 0; });
  std::vector<LeafLevels> pages;
  for (std::uint32_t leaf = 0; leaf < in.leaf_count(); ++leaf) {
    LeafLevels page{};
    page.leaf = leaf;
    bool needed = false;
    for_each_voxel(model.leaves[leaf], [&](int place) {
      const int filled = level(in.leaf_origin(leaf) + cell_in_leaf(place));
      page.levels[static_cast<std::size_t>(place)] = static_cast<FillLevel>(filled);
      needed = needed || filled < kFullLevel;
    });
    if (needed) pages.push_back(page);
  }
  model.fills.emplace(in.leaf_count(), std::move(pages));
  return model;
}

double convergence_deg(const VoxelModel& before, const VoxelModel& after) {
  return preparation_shape(closed_surface(before), closed_surface(after), {})
      .value()
      .convergence_deg.value()
      .value;
}

TEST(FlatWalls, OfBitsAreKnownWithinTwoDegrees) {
  const VoxelModel block = bits(-1);
  for (const double taper : {0.0, 1.0, 2.0, 3.0, 5.0}) {
    EXPECT_NEAR(convergence_deg(block, bits(taper)), 2.0 * taper, 2.0);
  }
}

TEST(FlatWalls, OfFractionsWithinHalfADegree) {
  const VoxelModel block = fractions(-1);
  for (const double taper : {0.0, 1.0, 2.5, 5.0}) {
    EXPECT_NEAR(convergence_deg(block, fractions(taper)), 2.0 * taper, 0.5);
  }
}

TEST(Roughness, OfGroovesIsAQuarterOfTheirDepth) {
  // The mean distance of a triangle's wave from its mean line.
  const test::Profile block{{0, -3}, {3.5, -3}, {3.5, 3}, {0, 3}};
  for (const double deep : {0.01, 0.02, 0.04, 0.06}) {
    test::Profile grooved{{0, -3}, {3.5, -3}, {3.5, 3}};
    for (int i = 0; i <= 20; ++i) grooved.emplace_back(i % 2 ? 1.2 : 1.2 + deep, 3.0 - 0.1 * i);
    grooved.emplace_back(0.0, 1.0);
    const Eigen::Affine3d upright = Eigen::Affine3d::Identity();
    const auto found = preparation_shape(test::turned_mesh(block, 100, upright),
                                         test::turned_mesh(grooved, 150, upright), {});
    ASSERT_TRUE(found && found->roughness_um) << deep;
    EXPECT_NEAR(found->roughness_um->value, 1e3 * deep / 4.0, 0.15 * 1e3 * deep / 4.0);
  }
}

TEST(WallLeft, IsWhatStandsBehindTheWall) {
  const test::Profile block{{0, -3}, {3.5, -3}, {3.5, 3}, {0, 3}};
  const Eigen::Affine3d upright = Eigen::Affine3d::Identity();
  for (const double radius : {1.0, 2.5, 3.2, 3.3, 3.4, 3.45}) {
    const test::Profile hole{{0, -3}, {3.5, -3}, {3.5, 3}, {radius, 3}, {radius, 1}, {0, 1}};
    const auto found = preparation_shape(test::turned_mesh(block, 200, upright),
                                         test::turned_mesh(hole, 331, upright), {});
    ASSERT_TRUE(found && found->wall_left_mm) << radius;
    EXPECT_NEAR(found->wall_left_mm->value, 3.5 - radius, 0.03) << radius;
  }
}

/// A hole of 1.1 mm, as a burr makes that went through the floor.
TEST(WallLeft, IsThatOfWhatWasCutRightThrough) {
  const auto block_with = [](bool hole) {
    return closed_surface(test::make_model({96, 64, 48}, 1e-3 * kVoxel_mm, [&](const Cell& c) {
      if ((c.array() < 4).any() || c.x() >= 92 || c.y() >= 60 || c.z() >= 44) return false;
      return !(hole && std::hypot(c.x() - 47.5, c.y() - 31.5) < 11.0);
    }));
  };
  const auto found = preparation_shape(block_with(false), block_with(true), {});
  ASSERT_TRUE(found && found->wall_left_mm);
  EXPECT_NEAR(found->wall_left_mm->value, 17 * kVoxel_mm, 0.08);
  EXPECT_FALSE(found->depth_mm) << "there is no floor";
}

}  // namespace
}  // namespace sulcus::flat_walls_test
