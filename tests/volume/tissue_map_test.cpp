#include "engine/volume/tissue_map.hpp"

#include <gtest/gtest.h>

namespace sulcus::tissue_map_test {
namespace {

constexpr LeafBits kAllSolid{{~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull}};
constexpr LeafBits kNoneSolid{};

LabelBlock labels_of(std::uint8_t label) {
  LabelBlock labels;
  labels.fill(label);
  return labels;
}

TEST(TissueMap, StartsAsTheFirstTissue) {
  const TissueMap map(3);
  EXPECT_EQ(map.leaf_count(), 3u);
  EXPECT_EQ(map.label(2, {1, 2, 3}), 0);
}

TEST(TissueMap, OneLabelIsStoredForALeafOfOneTissue) {
  TissueMap map(2);
  map.set_block(1, labels_of(4), kAllSolid);
  EXPECT_EQ(map.block(1), nullptr);
  EXPECT_EQ(map.uniform_label(1), 4);
  EXPECT_EQ(map.label(1, {7, 7, 7}), 4);
  EXPECT_EQ(map.label(0, {7, 7, 7}), 0);
}

TEST(TissueMap, AMixedLeafKeepsEveryLabel) {
  TissueMap map(1);
  LabelBlock labels;
  for (int v = 0; v < 512; ++v) labels[v] = static_cast<std::uint8_t>(v * 7);
  map.set_block(0, labels, kAllSolid);
  ASSERT_NE(map.block(0), nullptr);
  for (int v = 0; v < 512; ++v) {
    // Coordinates beyond the leaf count within it.
    const Cell c(8 + (v & 7), 16 + (v >> 3 & 7), 24 + (v >> 6));
    ASSERT_EQ(map.label(0, c), labels[v]);
  }
}

TEST(TissueMap, OnlySolidVoxelsCount) {
  TissueMap map(1);
  LabelBlock labels = labels_of(2);
  labels[8 * 8 * 5 + 8 * 3 + 1] = 9;  // voxel (1, 3, 5)
  auto solid = kAllSolid;
  solid.reset(leaf_place(Cell(1, 3, 5)));
  map.set_block(0, labels, solid);
  EXPECT_EQ(map.block(0), nullptr);
  EXPECT_EQ(map.uniform_label(0), 2);

  map.set_block(0, labels, kAllSolid);
  EXPECT_NE(map.block(0), nullptr);
}

TEST(TissueMap, OneVoxelOfAnotherTissueMixesALeafWhereverItIs) {
  for (int v = 0; v < 512; ++v) {
    TissueMap map(1);
    LabelBlock labels = labels_of(1);
    labels[v] = 2;
    map.set_block(0, labels, kAllSolid);
    ASSERT_NE(map.block(0), nullptr) << v;
  }
}

TEST(TissueMap, AnEmptyLeafIsUniform) {
  TissueMap map(1);
  LabelBlock labels = labels_of(3);
  labels[0] = 5;
  map.set_block(0, labels, kNoneSolid);
  EXPECT_EQ(map.block(0), nullptr);
  EXPECT_EQ(map.uniform_label(0), 0);
}

TEST(TissueMap, AMixedLeafBecomesUniformAgain) {
  TissueMap map(2);
  LabelBlock labels = labels_of(1);
  labels[100] = 2;
  map.set_block(0, labels, kAllSolid);
  map.set_block(1, labels, kAllSolid);
  const std::size_t mixed_bytes = map.memory_bytes();
  map.set_uniform(0, 6);
  EXPECT_EQ(map.block(0), nullptr);
  EXPECT_EQ(map.label(0, {4, 4, 1}), 6);
  EXPECT_EQ(map.memory_bytes() + sizeof(LabelBlock), mixed_bytes);
}

TEST(TissueMap, OfUniformLeavesAByteIsKept) {
  constexpr std::uint32_t kLeaves = 1 << 18;
  TissueMap map(kLeaves);
  for (std::uint32_t leaf = 0; leaf < kLeaves; ++leaf) map.set_uniform(leaf, 1);
  LabelBlock labels = labels_of(1);
  labels[100] = 2;
  map.set_block(kLeaves / 2, labels, kAllSolid);
  EXPECT_LE(map.memory_bytes(), kLeaves + sizeof labels + 4096);
}

}  // namespace
}  // namespace sulcus::tissue_map_test
