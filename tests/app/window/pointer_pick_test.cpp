#include "app/window/pointer_pick.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/filled_model.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::pointer_pick_test {
namespace {

const Eigen::Vector4f kAll = Eigen::Vector4f::UnitW();

/// The way to the nearest of all solid voxels' cubes, each asked on its own.
std::optional<double> brute_force(const VoxelModel& model, const Pose& world_from_grid,
                                  const SightLine& line, const Eigen::Vector4f& shown) {
  const Eigen::Vector3d from = world_from_grid.inverse_point(line.from_world);
  const Eigen::Vector3d way = world_from_grid.inverse_direction(line.way_world);
  const double at = shown.head<3>().cast<double>().dot(line.from_world) + shown.w();
  const double by = shown.head<3>().cast<double>().dot(line.way_world);
  double first = 0.0, last = 1e9;
  if (by > 0.0) first = std::max(first, -at / by);
  if (by < 0.0) last = std::min(last, -at / by);
  if (by == 0.0 && at < 0.0) return {};
  std::optional<double> nearest;
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (!model.solid(c) || model.level(c) < kFullLevel / 2.0) continue;
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * model.grid.voxel_m);
    const Eigen::Vector3d low = model.grid.centre_world(c) - half,
                          high = model.grid.centre_world(c) + half;
    double enter = first, leave = last;
    for (int a = 0; a < 3; ++a) {
      const double one = (low[a] - from[a]) / way[a], other = (high[a] - from[a]) / way[a];
      enter = std::max(enter, std::min(one, other));
      leave = std::min(leave, std::max(one, other));
    }
    if (enter < leave && (!nearest || enter < *nearest)) nearest = enter;
  }
  return nearest;
}

void expect_as_brute_force(const VoxelModel& model, const Pose& world_from_grid,
                           const Eigen::Vector4f& shown, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  const auto anywhere = [&] { return Eigen::Vector3d(side(random), side(random), side(random)); };
  const double size = model.grid.cells.maxCoeff() * model.grid.voxel_m;
  int met = 0, missed = 0;
  for (int i = 0; i < 300; ++i) {
    SightLine line;
    line.from_world = world_from_grid.point(1.5 * size * anywhere());
    line.way_world =
        (world_from_grid.point(0.5 * size * anywhere()) - line.from_world).normalized();
    const auto truth = brute_force(model, world_from_grid, line, shown);
    const auto picked = picked_point(model, world_from_grid, line, shown);
    ASSERT_EQ(picked.has_value(), truth.has_value()) << i;
    truth ? ++met : ++missed;
    if (!truth) continue;
    EXPECT_NEAR(picked->distance_m, *truth, 1e-9) << i;
    EXPECT_LT((picked->point_world - line.from_world - *truth * line.way_world).norm(), 1e-9);
    EXPECT_TRUE(model.solid(picked->cell));
  }
  EXPECT_GT(met, 50);
  EXPECT_GT(missed, 20);
}

TEST(PickedPoint, IsTheNearestOfAllSolidVoxelsAlongTheLine) {
  expect_as_brute_force(test::random_blobs({40, 32, 24}, 5), {}, kAll, 1);
}

TEST(PickedPoint, OnATurnedBodyToo) {
  Pose pose;
  pose.position = {1e-3, -2e-3, 0.5e-3};
  pose.orientation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  expect_as_brute_force(test::random_blobs({40, 32, 24}, 6), pose, kAll, 2);
}

TEST(PickedPoint, LeavesOutWhatASectionLeavesOutAndVoxelsLessThanHalfFull) {
  // What lies at y above 0.1 mm: its face is where the line comes in.
  const Eigen::Vector4f beyond(0.0f, 1.0f, 0.0f, -1e-4f);
  expect_as_brute_force(test::random_blobs({40, 32, 24}, 7), {}, beyond, 3);
  const VoxelModel filled = test::filled_anyhow(test::random_blobs({32, 32, 24}, 8), 4);
  expect_as_brute_force(filled, {}, kAll, 5);
}

TEST(PickedPoint, AlongAnAxisAndFromWithin) {
  const VoxelModel block = test::block({16, 16, 16}, 1e-4, {4, 4, 4}, {12, 12, 12});
  const auto down = picked_point(block, {}, {{0, 0, 1e-2}, -Eigen::Vector3d::UnitZ()}, kAll);
  ASSERT_TRUE(down);
  EXPECT_NEAR(down->point_world.z(), 4e-4, 1e-12);
  EXPECT_FALSE(picked_point(block, {}, {{5e-4, 0, 1e-2}, -Eigen::Vector3d::UnitZ()}, kAll));
  const auto within = picked_point(block, {}, {{1e-5, 0, 0}, Eigen::Vector3d::UnitX()}, kAll);
  ASSERT_TRUE(within);
  EXPECT_EQ(within->distance_m, 0.0);
}

}  // namespace
}  // namespace sulcus::pointer_pick_test
