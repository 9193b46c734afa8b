#include "engine/normals/map_group.hpp"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus {
namespace {

constexpr int kNs = 6, kTrace = 12;

TEST(MapGroup, HasTheMapsOfItsVoxelsAndOfNoneBefore) {
  const Workpiece workpiece(test::two_balls());
  std::vector<VoxelQuery> queries;
  for (const Cell& c : test::surface_cells(workpiece)) queries.push_back({c, {0.1f, 0.2f, 0.9f}});
  MapGroup group;
  LeafTiles tiles(workpiece, queries, kNs, false);
  std::size_t groups = 0, whole = 0, not_full = 0;
  for (std::size_t first = 0, count; first < queries.size(); first += count, ++groups) {
    count = group.take(workpiece, queries, first, kNs, kTrace, tiles);
    ASSERT_GT(count, 0u);
    ASSERT_EQ(group.sided() >> count, 0u) << "a lane that another group left";
    not_full += count < MapGroup::kSize ? 1 : 0;
    for (std::size_t k = 0; k < count; ++k) {
      ASSERT_EQ((group.sided() >> k & 1u) != 0, !group.coarse[k].isZero());
      if (group.coarse[k].isZero()) continue;
      HeightMap one;
      one.ns = kNs;
      trace_along(workpiece, queries[first + k].voxel, group.axes[k], kTrace, one);
      ASSERT_EQ(group.is_whole(k), one.whole_rings == kNs);
      const HeightMap& map = group.map(k);
      const auto bytes = static_cast<std::size_t>((2 * kNs + 1) * one.lanes);
      ASSERT_EQ(std::memcmp(map.height.data(), one.height.data(), bytes), 0);
      whole += group.is_whole(k) ? 1 : 0;
    }
  }
  EXPECT_GT(groups, 20u);
  EXPECT_GT(not_full, 5u);
  EXPECT_GT(whole, 100u);
}

}  // namespace
}  // namespace sulcus
