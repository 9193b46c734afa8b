#include "engine/outcome/voxel_distance.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::voxel_distance_test {
namespace {

VoxelSet set_of(const VoxelGrid& grid, const std::vector<Cell>& cells) {
  VoxelSet set(grid);
  for (const Cell& c : cells) set.insert(c);
  return set;
}

/// Over all pairs; sorted.
std::vector<std::uint32_t> plain_distances(const std::vector<Cell>& from,
                                           const std::vector<Cell>& to) {
  std::vector<std::uint32_t> distances;
  for (const Cell& a : from) {
    int least = std::numeric_limits<int>::max();
    for (const Cell& b : to) least = std::min(least, (a - b).squaredNorm());
    distances.push_back(static_cast<std::uint32_t>(least));
  }
  std::ranges::sort(distances);
  return distances;
}

void expect_as_all_pairs(const VoxelGrid& grid, const std::vector<Cell>& a,
                         const std::vector<Cell>& b) {
  const VoxelSet set_a = set_of(grid, a), set_b = set_of(grid, b);
  std::vector<std::uint32_t> distances = squared_distances(set_a, set_b);
  std::ranges::sort(distances);
  const std::vector<std::uint32_t> expected = plain_distances(a, b);
  EXPECT_EQ(distances, expected);
}

TEST(VoxelDistance, IsThatOfAllPairsOfSolids) {
  const Eigen::Vector3i cells(32, 40, 24);
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const VoxelModel a = test::random_blobs(cells, seed), b = test::random_blobs(cells, seed + 50);
    expect_as_all_pairs(a.grid, test::solid_cells(a), test::solid_cells(b));
  }
}

TEST(VoxelDistance, IsThatOfAllPairsOfScatteredVoxels) {
  std::mt19937 random(11);
  const VoxelGrid grid{{128, 64, 200}, 1e-4};
  for (const std::size_t count : {1u, 2u, 3u, 7u, 60u, 400u}) {
    std::vector<Cell> a, b;
    for (auto* cells : {&a, &b}) {
      std::vector<std::uint32_t> voxels;
      while (voxels.size() < count) {
        const auto v = static_cast<std::uint32_t>(random() % grid.cell_count());
        if (std::ranges::find(voxels, v) == voxels.end()) voxels.push_back(v);
      }
      for (const std::uint32_t v : voxels) cells->push_back(grid.cell_of_linear(v));
    }
    expect_as_all_pairs(grid, a, b);
  }
}

TEST(VoxelDistance, HoldsAcrossTheLargestGrid) {
  const VoxelGrid grid{{1024, 1024, 1024}, 1e-5};
  const VoxelSet a = set_of(grid, {{0, 0, 0}}), b = set_of(grid, {{1023, 1023, 1023}});
  EXPECT_EQ(squared_distances(a, b), std::vector<std::uint32_t>{3u * 1023 * 1023});
}

TEST(VoxelDistance, OfNothingIsNone) {
  const VoxelGrid grid{{16, 16, 16}, 1e-4};
  const VoxelSet none(grid), one = set_of(grid, {{3, 4, 5}});
  EXPECT_TRUE(squared_distances(none, one).empty());
  EXPECT_TRUE(squared_distances(one, none).empty());
}

}  // namespace
}  // namespace sulcus::voxel_distance_test
