#include "engine/normals/map_batch.hpp"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::map_batch_test {
namespace {

constexpr int kNs = 6, kTrace = 12;

TEST(MapBatch, HasTheMapsOfItsVoxelsAndOfNoneBefore) {
  const Workpiece workpiece(test::two_balls());
  std::vector<VoxelQuery> queries;
  for (const Cell& c : test::surface_cells(workpiece)) queries.push_back({c, {0.1f, 0.2f, 0.9f}});
  MapBatch batch(workpiece, queries, kNs, kTrace, FitWindow::kWholeMap);
  std::size_t batches = 0, whole = 0, not_full = 0, tiled = 0;
  for (std::size_t first = 0, count; first < queries.size(); first += count, ++batches) {
    count = batch.take(first, MapBatch::kMaps);
    ASSERT_GT(count, 0u);
    ASSERT_EQ(batch.has_direction >> count, 0u) << "a lane that another batch left";
    not_full += count < MapBatch::kMaps ? 1 : 0;
    VoxelBits rest = batch.has_direction & ~batch.in_tile;
    for (const std::size_t k : batch.trace_some(rest)) batch.fit_traced(k);
    ASSERT_EQ(rest, 0u);
    for (std::size_t k = 0; k < count; ++k) {
      ASSERT_EQ(has_bit(batch.has_direction, k), !batch.coarse(k).isZero());
      if (batch.coarse(k).isZero()) continue;
      HeightMap one;
      one.ns = kNs;
      trace_along(workpiece, queries[first + k].voxel, batch.axes(k), batch.coarse(k), kTrace, one);
      ASSERT_EQ(has_bit(batch.whole, k), one.whole_rings == kNs);
      tiled += has_bit(batch.in_tile, k) ? 1 : 0;
      const HeightMap& map = batch.map(k);
      const auto bytes = static_cast<std::size_t>((2 * kNs + 1) * one.lanes);
      ASSERT_EQ(std::memcmp(map.height.data(), one.height.data(), bytes), 0);
      whole += has_bit(batch.whole, k) ? 1 : 0;
    }
  }
  EXPECT_GT(batches, 20u);
  EXPECT_GT(not_full, 5u);
  EXPECT_GT(whole, 100u);
  EXPECT_GT(tiled, 100u);
}

}  // namespace
}  // namespace sulcus::map_batch_test
