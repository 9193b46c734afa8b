#include "haptics/loose_schedule.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::loose_schedule_test {
namespace {

LooseAnswer answer(std::uint64_t asked, std::size_t size = 0) {
  LooseAnswer a{asked, {}, {}};
  for (std::uint32_t voxel = 0; voxel < size; ++voxel) a.voxels.push_back(voxel);
  if (size > 0) a.ends.push_back(size);
  return a;
}

TEST(LooseSchedule, AnAnswerIsTakenFiftyTicksAfterItsQuestion) {
  LooseSchedule schedule;
  std::uint64_t asked = 9;
  for (std::uint64_t tick = 0; tick < 200; ++tick) {
    schedule.before_tick(tick, [&](LooseAnswer& now) {
      now = answer(asked);
      asked += 10;
      return true;
    });
    const bool due = tick >= 59 && tick % 10 == 9;
    ASSERT_EQ(schedule.taken().size(), due ? 1u : 0u) << tick;
    if (due) {
      EXPECT_EQ(schedule.taken()[0].asked, tick - 50);
      EXPECT_EQ(schedule.taken()[0].taken, tick);
    }
  }
}

TEST(LooseSchedule, WhatIsLooseLeavesInItsOrderSoManyATick) {
  LooseSchedule schedule;
  std::vector<std::uint32_t> left;
  bool given = false;
  for (std::uint64_t tick = 0; tick < 99; ++tick) {
    const auto voxels = schedule.before_tick(tick, [&](LooseAnswer& now) {
      if (given) return false;
      now = answer(9, 18000);
      return given = true;
    });
    EXPECT_LE(voxels.size(), kLeavePerTick);
    if (tick < 59) {
      EXPECT_TRUE(voxels.empty());
    }
    left.insert(left.end(), voxels.begin(), voxels.end());
    EXPECT_EQ(schedule.left(), left.size());
  }
  ASSERT_EQ(left.size(), 18000u);
  for (std::uint32_t i = 0; i < left.size(); ++i) EXPECT_EQ(left[i], i);
}

/// What left in which tick, and what was taken, with two answers that are there from a tick on.
struct Left {
  std::vector<std::pair<std::uint64_t, std::size_t>> voxels;
  std::vector<TakenAnswer> taken;
};
Left run(LooseSchedule schedule, std::uint64_t there_from, std::uint64_t ticks = 120) {
  Left left;
  int given = 0;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    const auto voxels = schedule.before_tick(tick, [&](LooseAnswer& now) {
      if (tick < there_from || given == 2) return false;
      now = given++ == 0 ? answer(9, 3) : answer(19, 5);
      return true;
    });
    if (!voxels.empty()) left.voxels.push_back({tick, voxels.size()});
    left.taken.insert(left.taken.end(), schedule.taken().begin(), schedule.taken().end());
  }
  return left;
}

TEST(LooseSchedule, ALateAnswerIsTakenWhenItIsThereAndPlayedBackSo) {
  const Left slow = run(LooseSchedule(), 64);
  ASSERT_EQ(slow.voxels.size(), 2u);
  EXPECT_EQ(slow.voxels[0], std::pair(std::uint64_t{64}, std::size_t{3}));
  EXPECT_EQ(slow.voxels[1], std::pair(std::uint64_t{69}, std::size_t{5})) << "this one is in time";
  EXPECT_EQ(run(LooseSchedule(slow.taken), 0).voxels, slow.voxels) << "though it is there at once";
}

TEST(LooseSchedule, AnAnswerThatARunDidNotTakeIsNotTakenInItsReplay) {
  const Left stopped = run(LooseSchedule(), 68, 66);
  EXPECT_TRUE(stopped.taken.empty());
  EXPECT_TRUE(run(LooseSchedule(stopped.taken), 0).voxels.empty());
}

TEST(LooseFinder, AnswersAfterTheTickThatAsks) {
  // Two blocks that a bridge of one voxel joins.
  VoxelModel model = test::block({32, 16, 16}, 50e-6, {2, 2, 2}, {10, 10, 10});
  for (int i = 10; i < 16; ++i) model.set({i, 5, 5}, true);
  for (const Cell& c : {Cell(16, 5, 5), Cell(16, 6, 5), Cell(17, 5, 5)}) model.set(c, true);
  LooseFinder finder(model);
  const Edit cut{0, model.grid.linear({12, 5, 5}), 0, EditCause::kCut};
  for (std::uint64_t tick = 0; tick < 50; ++tick) {
    const auto found =
        finder.add_tick(tick, tick == 3 ? std::span(&cut, 1) : std::span<const Edit>{});
    ASSERT_EQ(found.has_value(), tick % 10 == 9) << tick;
    if (!found) continue;
    EXPECT_EQ(found->asked, tick);
    EXPECT_EQ(found->voxels.size(), tick == 9 ? 6u : 0u);
    EXPECT_EQ(found->ends.size(), tick == 9 ? 1u : 0u);
  }
  EXPECT_FALSE(finder.model().solid({16, 5, 5}));
}

TEST(LooseFinder, WhatIsCutOfAnotherBodyIsNotItsOwn) {
  const VoxelModel start = test::block({16, 16, 16}, 1e-4, {4, 4, 4}, {12, 12, 12});
  LooseFinder finder(start);
  const Edit of_another{3, start.grid.linear({5, 5, 5}), 1, EditCause::kCut};
  finder.add_tick(3, {&of_another, 1});
  EXPECT_EQ(finder.model().leaves, start.leaves);
  const Edit of_the_workpiece{4, of_another.voxel, 0, EditCause::kCut};
  finder.add_tick(4, {&of_the_workpiece, 1});
  EXPECT_FALSE(finder.model().solid({5, 5, 5}));
}

TEST(LooseFinder, AVoxelThatIsOnlyLessFilledHoldsOn) {
  // Two blocks and a voxel between them.
  const VoxelModel start = test::make_model({16, 16, 16}, 1e-4, [](const Cell& c) {
    return c.x() < 6 || c.x() > 6 || c == Cell(6, 5, 5);
  });
  LooseFinder finder(start);
  Edit edit{9, start.grid.linear({6, 5, 5}), 0, EditCause::kCut, 1};
  EXPECT_TRUE(finder.add_tick(9, {&edit, 1})->voxels.empty());
  edit.level = 0;
  EXPECT_EQ(finder.add_tick(19, {&edit, 1})->voxels.size(), 6u * 16 * 16);
}

}  // namespace
}  // namespace sulcus::loose_schedule_test
