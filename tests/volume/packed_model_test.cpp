#include "engine/volume/packed_model.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::packed_model_test {
namespace {

TEST(PackedModel, HoldsTheLeavesThatAreNotEmptyAndGivesThemBack) {
  VoxelModel model = test::random_blobs({48, 40, 32}, 7);
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  std::size_t solid = 0, mixed = 0;
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int v = 0; v < 512; ++v) labels[v] = leaf % 3 == 0 && v % 2 == 0 ? 2 : 1;
    tissues->set_block(leaf, labels, model.leaves[leaf]);
    solid += model.leaves[leaf] != LeafBits{};
    mixed += tissues->block(leaf) != nullptr;
  }
  model.tissues = tissues;
  model.clipped = true;
  ASSERT_LT(solid, model.leaves.size());
  ASSERT_GT(mixed, 0u);

  const PackedModel packed = pack(model);
  EXPECT_EQ(packed.leaves.size(), solid);
  EXPECT_EQ(packed.words.size(), solid);
  EXPECT_EQ(packed.leaf_labels.size(), solid);
  EXPECT_EQ(packed.mixed.size(), mixed);
  EXPECT_EQ(packed.mixed_labels.size(), mixed);
  EXPECT_TRUE(is_rising_below(packed.leaves, model.grid.leaf_count()));
  EXPECT_TRUE(is_rising_below(packed.mixed, solid));

  const VoxelModel again = unpack(packed);
  EXPECT_EQ(again.grid.cells, model.grid.cells);
  EXPECT_TRUE(again.clipped);
  ASSERT_EQ(again.leaves, model.leaves);
  for (const Cell& c : test::solid_cells(model)) ASSERT_EQ(again.tissue(c), model.tissue(c));
}

TEST(PackedModel, OneTissueHasNoLabels) {
  const VoxelModel model = test::random_blobs({24, 24, 24}, 8);
  const PackedModel packed = pack(model);
  EXPECT_FALSE(packed.labelled);
  EXPECT_TRUE(packed.leaf_labels.empty());
  const VoxelModel again = unpack(packed);
  EXPECT_EQ(again.leaves, model.leaves);
  EXPECT_EQ(again.tissues, nullptr);
}

TEST(PackedModel, IndicesRiseAndEnd) {
  EXPECT_TRUE(is_rising_below({}, 0));
  EXPECT_TRUE(is_rising_below({0, 2, 5}, 6));
  EXPECT_FALSE(is_rising_below({0, 2, 5}, 5));
  EXPECT_FALSE(is_rising_below({0, 2, 2}, 6));
  EXPECT_FALSE(is_rising_below({3, 2}, 6));
}

}  // namespace
}  // namespace sulcus::packed_model_test
