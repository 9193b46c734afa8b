#include "engine/outcome/voxel_set.hpp"

#include <set>

#include <gtest/gtest.h>

#include "tests/outcome/labelled_model.hpp"

namespace sulcus::voxel_set_test {
namespace {

TEST(VoxelSet, HoldsWhatWasPutInOnce) {
  const VoxelModel model = test::random_blobs({32, 24, 40}, 3);
  VoxelSet set(model.grid);
  std::uint64_t inserted = 0;
  for (const Cell& c : test::solid_cells(model)) {
    EXPECT_TRUE(set.insert(c));
    EXPECT_FALSE(set.insert(c));
    ++inserted;
  }
  EXPECT_EQ(set.count(), inserted);
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    EXPECT_EQ(set.contains(c), model.solid(c));
  }
  EXPECT_FALSE(set.contains({-1, 0, 0}));
  EXPECT_FALSE(set.contains({0, 24, 0}));
}

TEST(VoxelSet, TakesMemoryForTheLeavesThatHoldVoxels) {
  const VoxelGrid grid{{512, 512, 512}, 1e-5};
  VoxelSet set(grid);
  set.insert({100, 200, 300});
  EXPECT_LT(set.memory_bytes(), grid.leaf_count() * 4 + 1000);
}

TEST(VoxelSet, CountsVoxelsOfALeafOnce) {
  const VoxelModel model = test::random_blobs({16, 16, 16}, 5);
  VoxelSet set(model.grid);
  for (std::uint32_t leaf = 0; leaf < model.leaves.size(); ++leaf) {
    set.insert(leaf, model.leaves[leaf]);
    set.insert(leaf, model.leaves[leaf]);
  }
  EXPECT_EQ(set.count(), model.solid_count());
  EXPECT_EQ(without(set, set).count(), 0u);
  EXPECT_EQ(without(set, VoxelSet(model.grid)).count(), set.count());
}

TEST(VoxelSet, ATissueIsItsSolidVoxels) {
  const auto label = [](const Cell& c) { return static_cast<std::uint8_t>((c.x() + c.z()) / 16); };
  const VoxelModel model = test::labelled(test::random_blobs({32, 32, 32}, 7), label);
  for (std::uint8_t tissue = 0; tissue < 4; ++tissue) {
    const VoxelSet set = voxels_of_tissue(model, tissue);
    for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
      const Cell c = model.grid.cell_of_linear(v);
      EXPECT_EQ(set.contains(c), model.solid(c) && label(c) == tissue);
    }
  }
  // Without labels there is one tissue, the first.
  const VoxelModel plain = test::random_blobs({32, 32, 32}, 7);
  EXPECT_EQ(voxels_of_tissue(plain, 0).count(), plain.solid_count());
  EXPECT_EQ(voxels_of_tissue(plain, 1).count(), 0u);
}

}  // namespace
}  // namespace sulcus::voxel_set_test
