#include "engine/volume/fill_map.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/workpiece.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::fill_map_test {
namespace {

FillLevel level_of(std::mt19937& random) {
  constexpr std::array<int, 5> kSome{0, 1, 128, 254, 255};
  return static_cast<FillLevel>(kSome[random() % 5]);
}

TEST(FillMap, AVoxelIsSolidWhereItsLevelIsAboveZero) {
  std::mt19937 random(1);
  std::vector<FillLevel> levels;
  const VoxelModel model = test::filled_model(
      {16, 24, 8}, 1e-4, [&](const Cell&) { return levels.emplace_back(level_of(random)); });
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    ASSERT_EQ(model.level(c), levels[v]);
    ASSERT_EQ(model.solid(c), levels[v] > 0);
  }
  EXPECT_EQ(model.level({-1, 0, 0}), 0);
}

TEST(FillMap, TakesNoMemoryBeyondItsRoom) {
  VoxelModel model = test::block({24, 8, 8}, 1e-4, {0, 0, 0}, {24, 8, 8});
  model.fills.emplace(model.grid.leaf_count(), std::vector<LeafLevels>{});
  Workpiece workpiece(std::move(model));
  EXPECT_FALSE(workpiece.set_level({1, 1, 1}, 100)) << "no room was asked for";
  EXPECT_EQ(workpiece.level({1, 1, 1}), kFullLevel);
  workpiece.reserve_fills(2);
  EXPECT_TRUE(workpiece.set_level({1, 1, 1}, 100));
  EXPECT_TRUE(workpiece.set_level({9, 1, 1}, 100));
  EXPECT_TRUE(workpiece.set_level({2, 1, 1}, 50)) << "the leaf has a page";
  EXPECT_FALSE(workpiece.set_level({17, 1, 1}, 100)) << "the third leaf";
  workpiece.remove({17, 1, 1});  // needs none
  EXPECT_EQ(workpiece.level({17, 1, 1}), 0);
  EXPECT_EQ(workpiece.level({18, 1, 1}), kFullLevel);
}

TEST(FillMap, TheHashIsThatOfTheShapeHoweverItWasReached) {
  std::mt19937 random(5);
  const Eigen::Vector3i cells(16, 16, 16);
  VoxelModel full = test::block(cells, 1e-4, {0, 0, 0}, {16, 16, 16});
  full.fills.emplace(full.grid.leaf_count(), std::vector<LeafLevels>{});
  full.fills->reserve(full.grid.leaf_count());
  Workpiece workpiece{VoxelModel(full)};
  workpiece.reserve_fills(full.grid.leaf_count());
  for (int n = 0; n < 4000; ++n) {
    const Cell c(static_cast<int>(random() % 16), static_cast<int>(random() % 16),
                 static_cast<int>(random() % 16));
    const FillLevel level = level_of(random);
    if (workpiece.solid(c)) {
      level == 0 ? workpiece.remove(c) : void(workpiece.set_level(c, level));
    } else if (level > 0) {
      workpiece.put_back(c, level);
    }
    if (n % 500 != 0) continue;
    const Workpiece anew(
        test::filled_model(cells, 1e-4, [&](const Cell& at) { return workpiece.level(at); }));
    ASSERT_EQ(workpiece.hash(), anew.hash());
    ASSERT_EQ(workpiece.surface_voxels(), anew.surface_voxels());
  }
  const std::uint64_t before = workpiece.hash();
  for (std::uint32_t v = 0; v < full.grid.cell_count(); ++v) {
    const Cell c = full.grid.cell_of_linear(v);
    workpiece.solid(c) ? void(workpiece.set_level(c, kFullLevel)) : workpiece.put_back(c);
  }
  EXPECT_NE(workpiece.hash(), before);
  const Workpiece binary(test::block(cells, 1e-4, {0, 0, 0}, {16, 16, 16}));
  EXPECT_EQ(workpiece.hash(), binary.hash()) << "all full is binary";
}

TEST(FillMap, ABinaryModelHasNone) {
  const Workpiece workpiece(test::block({8, 8, 8}, 1e-4, {0, 0, 0}, {8, 8, 4}));
  EXPECT_FALSE(workpiece.has_fills());
  EXPECT_EQ(workpiece.level({1, 1, 1}), kFullLevel);
  EXPECT_EQ(workpiece.level({1, 1, 5}), 0);
}

}  // namespace
}  // namespace sulcus::fill_map_test
