#include "haptics/way_through.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::way_through_test {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 50e-6;

/// A wall of one voxel across x, in the middle of the grid: solid from 0 to one voxel.
VoxelModel wall() { return test::block({64, 64, 64}, kVoxel, {32, 0, 0}, {33, 64, 64}); }

TEST(WayThrough, APointIsInsideWhereItsVoxelIsSolid) {
  const VoxelModel thin = wall();
  EXPECT_TRUE(is_inside(thin, {}, Vector3d(0.5 * kVoxel, 0, 0)));
  EXPECT_FALSE(is_inside(thin, {}, Vector3d(-0.1 * kVoxel, 0, 0)));
  EXPECT_FALSE(is_inside(thin, {}, Vector3d(1.1 * kVoxel, 0, 0)));
  EXPECT_FALSE(is_inside(thin, {}, Vector3d(0, 1.0, 0))) << "beyond the grid";
  EXPECT_FALSE(is_inside(thin, {}, Vector3d(0, 1e300, 0)));
  EXPECT_FALSE(is_inside(thin, {}, Vector3d(0, std::nan(""), 0)));
  const Pose aside{{0, 0, 5e-3},
                   Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()))};
  EXPECT_TRUE(is_inside(thin, aside, Vector3d(0, 0, 5e-3 - 0.5 * kVoxel)));
}

TEST(WayThrough, NoWallOfOneVoxelIsPassedUnseenAtAnySpeed) {
  const VoxelModel thin = wall();
  for (const double step : {0.6, 1.0, 3.0, 7.3, 31.0}) {  // voxels
    int seen = 0;
    for (double x = -40.0; x < 40.0; x += step) {
      const Vector3d from(x * kVoxel, 0.1e-3, 0), to((x + step) * kVoxel, 0.1e-3, 0);
      seen += goes_through(thin, {}, from, to) ? 1 : 0;
    }
    EXPECT_GE(seen, 1) << step;
    EXPECT_LE(seen, 2) << step << ": into it and out of it";
  }
}

TEST(WayThrough, BesideAWallOrWithinAVoxelNothingIsGoneThrough) {
  const VoxelModel thin = wall();
  EXPECT_FALSE(goes_through(thin, {}, Vector3d(-1e-3, 0, 0), Vector3d(-0.1 * kVoxel, 0, 0)));
  EXPECT_FALSE(goes_through(thin, {}, Vector3d(-1e-3, -1e-3, 0), Vector3d(-1e-3, 1e-3, 0)));
  EXPECT_FALSE(goes_through(thin, {}, Vector3d(-0.1 * kVoxel, 0, 0), Vector3d(0.2 * kVoxel, 0, 0)));
  EXPECT_FALSE(goes_through(thin, {}, Vector3d(0.5 * kVoxel, 0, 0), Vector3d(1e-3, 0, 0)))
      << "out of it";
}

}  // namespace
}  // namespace sulcus::way_through_test
