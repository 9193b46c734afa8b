#include <cmath>

#include <gtest/gtest.h>

#include "engine/outcome/goal.hpp"

namespace sulcus::goal_distance_test {
namespace {

/// A block of 24^3 voxels in a grid of 32^3, a target of 8^3 at the middle of its upper face
/// (z = 27), and what of it was removed.
struct Block {
  VoxelModel now;
  VoxelSet target, removed;

  Block() : now{{{32, 32, 32}, 1e-4}, {}, {}}, target(now.grid), removed(now.grid) {
    now.leaves.resize(now.grid.leaf_count());
    for (int n = 0; n < 24 * 24 * 24; ++n) {
      now.set(Cell(n % 24 + 4, n / 24 % 24 + 4, n / 24 / 24 + 4), true);
    }
    for (int n = 0; n < 8 * 8 * 8; ++n)
      target.insert(Cell(n % 8 + 12, n / 8 % 8 + 12, n / 64 + 20));
  }
  void remove(const Cell& low, const Cell& high) {
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          now.set(Cell(x, y, z), false);
          removed.insert(Cell(x, y, z));
        }
      }
    }
  }
  VoxelValues distances() const { return goal_distances(now, removed, target); }
};

TEST(GoalDistance, BeforeTheFirstCutWhatIsMissingStandsOnItsWalls) {
  const VoxelValues distances = Block().distances();
  // On the upper face, by the voxels to the nearest wall: 1 at the target's edge, 4 in its middle.
  EXPECT_FLOAT_EQ(distances.at(Cell(12, 15, 27)), -1e-4f);
  EXPECT_FLOAT_EQ(distances.at(Cell(15, 15, 27)), -4e-4f);
  EXPECT_TRUE(std::isnan(distances.at(Cell(11, 15, 27)))) << "the goal is not about it";
  EXPECT_TRUE(std::isnan(distances.at(Cell(15, 15, 26)))) << "it is not at the surface";
}

TEST(GoalDistance, ACutOfTheTargetEndsAtItsWalls) {
  Block block;
  block.remove({12, 12, 20}, {19, 19, 27});
  const VoxelValues distances = block.distances();
  EXPECT_FLOAT_EQ(distances.at(Cell(11, 15, 24)), 0.0f);
  EXPECT_FLOAT_EQ(distances.at(Cell(15, 15, 19)), 0.0f);
  EXPECT_TRUE(std::isnan(distances.at(Cell(4, 15, 15)))) << "an outer face of the block";
}

TEST(GoalDistance, WhatIsCutTooFarAndTooLittleHasItsSizeAndSign) {
  Block block;
  // Two voxels too far at low x, three too little at high x, one too deep.
  block.remove({10, 12, 19}, {16, 19, 27});
  const VoxelValues distances = block.distances();
  EXPECT_FLOAT_EQ(distances.at(Cell(9, 15, 24)), 2e-4f);
  EXPECT_FLOAT_EQ(distances.at(Cell(17, 15, 24)), -3e-4f);
  EXPECT_FLOAT_EQ(distances.at(Cell(14, 15, 18)), 1e-4f);
}

TEST(GoalDistance, ATargetOfAllOfTheToothHasNoWalls) {
  Block block;
  for (std::uint32_t leaf = 0; leaf < block.now.leaves.size(); ++leaf) {
    block.target.insert(leaf, block.now.leaves[leaf]);
  }
  block.remove({12, 12, 20}, {19, 19, 27});
  EXPECT_TRUE(block.distances().blocks().empty());
}

}  // namespace
}  // namespace sulcus::goal_distance_test
