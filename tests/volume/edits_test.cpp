#include "engine/volume/edits.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/level_changes.hpp"
#include "tests/support/filled_model.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::edits_test {
namespace {

/// Edits that fall to nothing or less, and what each voxel had before; with fractions only those
/// lower.
struct Changes {
  std::vector<Edit> edits;
  std::vector<FillLevel> before;
};

/// Levels by voxel, as plain numbers: what the edits come to.
std::vector<FillLevel> levels_of(const VoxelModel& model) {
  std::vector<FillLevel> levels;
  for (std::uint32_t voxel = 0; voxel < model.grid.cell_count(); ++voxel) {
    levels.push_back(model.level(model.grid.cell_of_linear(voxel)));
  }
  return levels;
}

Changes any_changes(const VoxelModel& start, std::size_t count) {
  std::mt19937 random(11);
  std::vector<FillLevel> levels = levels_of(start);
  Changes changes;
  while (changes.edits.size() < count) {
    const auto voxel = static_cast<std::uint32_t>(random() % levels.size());
    if (levels[voxel] == 0) continue;
    const bool goes = !start.fills || random() % 4 == 0 || levels[voxel] == 1;
    const auto to =
        goes ? FillLevel{0} : static_cast<FillLevel>(1 + random() % (levels[voxel] - 1u));
    changes.before.push_back(levels[voxel]);
    changes.edits.push_back({changes.edits.size() / 3, voxel, 0, EditCause::kCut, to});
    levels[voxel] = to;
  }
  return changes;
}

class Edits : public testing::TestWithParam<bool> {
 protected:
  static VoxelModel start() {
    VoxelModel blobs = test::random_blobs({32, 24, 16}, 5);
    return GetParam() ? test::filled_anyhow(std::move(blobs), 6) : blobs;
  }
};

TEST_P(Edits, GoOnAndBackToWhereTheyCameFrom) {
  const VoxelModel first = start();
  const Changes changes = any_changes(first, 3000);
  VoxelModel model = first;
  Workpiece workpiece(first);
  std::vector<std::vector<FillLevel>> way{levels_of(first)};
  for (const Edit& edit : changes.edits) {
    way.push_back(way.back());
    way.back()[edit.voxel] = edit.level;
  }
  std::mt19937 random(3);
  std::size_t at = 0;
  for (int jump = 0; jump < 12; ++jump) {
    const std::size_t to = jump == 11 ? 0 : random() % way.size();
    for (; at < to; ++at) {
      apply_edit(changes.edits[at], model);
      apply_edit(changes.edits[at], workpiece);
    }
    for (; at > to; --at) {
      take_back_edit(changes.edits[at - 1], changes.before[at - 1], model);
      take_back_edit(changes.edits[at - 1], changes.before[at - 1], workpiece);
    }
    ASSERT_EQ(levels_of(model), way[at]) << at;
    ASSERT_EQ(levels_of(workpiece.model()), way[at]) << at;
    const Workpiece made_anew(model);
    ASSERT_EQ(workpiece.hash(), made_anew.hash()) << at;
    ASSERT_EQ(workpiece.solid_voxels(), made_anew.solid_voxels());
    ASSERT_EQ(workpiece.surface_voxels(), made_anew.surface_voxels());
  }
}

TEST_P(Edits, EachIsKnownWithTheLevelBefore) {
  const VoxelModel first = start();
  const Changes changes = any_changes(first, 3000);
  LevelChanges levels(first);
  for (std::size_t i = 0; i < changes.edits.size(); ++i) {
    ASSERT_EQ(levels.before(changes.edits[i]), changes.before[i]) << i;
  }
  EXPECT_EQ(levels.memory_bytes() > 0, GetParam()) << "a binary body needs none";
}

INSTANTIATE_TEST_SUITE_P(BinaryAndFilled, Edits, testing::Bool());

TEST(EditsInOrder, OfATickWhatIsLoweredComesFirst) {
  const std::vector<Edit> lowered{{1, 5, 0, EditCause::kCut, 9}, {3, 5, 0, EditCause::kCut, 7}};
  const std::vector<Edit> gone{
      {1, 6, 0, EditCause::kCut}, {2, 7, 0, EditCause::kLoose}, {3, 5, 0, EditCause::kCut}};
  std::vector<std::uint32_t> voxels;
  for (const Edit& edit : in_order(lowered, gone)) voxels.push_back(10 * edit.voxel + edit.level);
  EXPECT_EQ(voxels, (std::vector<std::uint32_t>{59, 60, 70, 57, 50}));
}

}  // namespace
}  // namespace sulcus::edits_test
