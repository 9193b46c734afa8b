#include "engine/volume/grid.hpp"

#include <set>

#include <gtest/gtest.h>

namespace sulcus::grid_test {
namespace {

using Eigen::Vector3d;

const VoxelGrid kGrid{{8, 24, 16}, 50e-6};

TEST(VoxelKey, GoesThereAndBack) {
  for (const Cell& c : {Cell(0, 0, 0), Cell(1023, 0, 0), Cell(0, 1023, 0), Cell(0, 0, 1023),
                        Cell(1023, 1023, 1023), Cell(5, 600, 77)}) {
    EXPECT_EQ(cell_of_key(voxel_key(c)), c);
  }
}

TEST(VoxelKey, HasTenBitsAnAxis) {
  EXPECT_EQ(voxel_key(1, 0, 0), 1u);
  EXPECT_EQ(voxel_key(0, 1, 0), 1u << 10);
  EXPECT_EQ(voxel_key(0, 0, 1), 1u << 20);
  EXPECT_EQ(voxel_key(1023, 1023, 1023), (1u << 30) - 1);
}

TEST(VoxelGrid, LinearGoesThereAndBackOverAllCells) {
  for (std::uint32_t v = 0; v < kGrid.cell_count(); ++v) {
    const Cell c = kGrid.cell_of_linear(v);
    ASSERT_TRUE(kGrid.contains(c));
    ASSERT_EQ(kGrid.linear(c), v);
  }
  EXPECT_EQ(kGrid.linear({1, 2, 3}), 1u + 2u * 8u + 3u * 8u * 24u);
}

TEST(VoxelGrid, LinearHoldsTheLargestGrid) {
  const VoxelGrid grid{{1024, 1024, 1024}, 1e-5};
  EXPECT_EQ(grid.linear({1023, 1023, 1023}), (1u << 30) - 1);
  EXPECT_EQ(grid.cell_of_linear((1u << 30) - 1), Cell(1023, 1023, 1023));
}

TEST(VoxelGrid, ItsCentreIsTheOriginOfTheScene) {
  const Vector3d outer = kGrid.centre_world({7, 23, 15});
  EXPECT_TRUE(outer.isApprox(-kGrid.centre_world({0, 0, 0}), 1e-12));
  EXPECT_TRUE(outer.isApprox(Vector3d(3.5, 11.5, 7.5) * 50e-6, 1e-12));
}

TEST(VoxelGrid, WorldAndIndexAreInverse) {
  const Vector3d p(1.25, -3.5, 40.0);
  EXPECT_TRUE(kGrid.index_from_world(kGrid.world_from_index(p)).isApprox(p, 1e-12));
}

TEST(VoxelGrid, ContainsNothingBeyondItsFaces) {
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_FALSE(kGrid.contains(-Cell::Unit(axis)));
    EXPECT_FALSE(kGrid.contains(kGrid.cells[axis] * Cell::Unit(axis)));
    EXPECT_TRUE(kGrid.contains((kGrid.cells[axis] - 1) * Cell::Unit(axis)));
  }
}

TEST(VoxelGrid, LeavesPartTheCells) {
  std::set<std::uint64_t> places;
  for (std::uint32_t v = 0; v < kGrid.cell_count(); ++v) {
    const Cell c = kGrid.cell_of_linear(v);
    const std::uint32_t leaf = kGrid.leaf_of(c);
    ASSERT_LT(leaf, kGrid.leaf_count());
    ASSERT_EQ(kGrid.leaf_origin(leaf), Cell(c / 8 * 8));
    places.insert(std::uint64_t{leaf} << 32 | static_cast<unsigned>(leaf_place(c)));
  }
  EXPECT_EQ(places.size(), kGrid.cell_count());
}

}  // namespace
}  // namespace sulcus::grid_test
