#include "engine/normals/tool_say.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/normals/ldm.hpp"
#include "engine/normals/ldm_fast.hpp"
#include "tests/support/normal_errors.hpp"

namespace sulcus {
namespace {

constexpr int kNs = 6, kTrace = 12;

TEST(ToolSay, WhatIsDroppedIsTheSameWithoutTheToolAndTheRestKeepsItsOrder) {
  const Workpiece workpiece(test::random_blobs({40, 32, 48}, 9));
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  std::vector<VoxelQuery> all;
  for (const Cell& c : test::surface_cells(workpiece)) {
    all.push_back({c, {unit(random), unit(random), unit(random)}});
  }
  std::vector<VoxelQuery> left = all;
  std::vector<std::uint32_t> places;
  for (std::uint32_t k = 0; k < all.size(); ++k) places.push_back(100 + k);
  drop_unheard(workpiece, left, places);
  ASSERT_EQ(left.size(), places.size());

  std::size_t next = 0, dropped = 0;
  for (std::uint32_t k = 0; k < all.size(); ++k) {
    const auto& [voxel, outward] = all[k];
    if (next < places.size() && places[next] == 100 + k) {
      ASSERT_EQ(left[next].voxel, voxel);
      ASSERT_EQ(left[next].outward, outward);
      ++next;
      continue;
    }
    ++dropped;
    ASSERT_TRUE(test::same_bits(estimate_ldm(workpiece, voxel, kNs, kTrace),
                                estimate_ldm(workpiece, voxel, kNs, kTrace, outward)));
    ASSERT_TRUE(test::same_bits(estimate_ldm_fast(workpiece, voxel, kNs, kTrace),
                                estimate_ldm_fast(workpiece, voxel, kNs, kTrace, outward)));
  }
  EXPECT_EQ(next, left.size());
  EXPECT_GT(dropped, all.size() / 10);
  EXPECT_GT(left.size(), all.size() / 2);
}

}  // namespace
}  // namespace sulcus
