#include "app/loose_schedule.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus {
namespace {

LooseAnswer answer(std::uint64_t asked, std::vector<std::size_t> sizes = {}) {
  LooseAnswer a{asked, {}};
  std::uint32_t voxel = 0;
  for (const std::size_t size : sizes) {
    LoosePiece& piece = a.pieces.emplace_back();
    for (std::size_t i = 0; i < size; ++i) piece.voxels.push_back(voxel++);
  }
  return a;
}

TEST(LooseSchedule, AnAnswerIsTakenFiftyTicksAfterItsQuestion) {
  LooseSchedule schedule;
  std::vector<std::uint64_t> taken;
  LooseAnswer now;
  std::uint64_t asked = 24;
  for (std::uint64_t tick = 0; tick < 200; ++tick) {
    schedule.before_tick(tick, [&] {
      taken.push_back(tick);
      now = answer(asked);
      asked += 25;
      return &now;
    });
    EXPECT_TRUE(schedule.late().empty());
  }
  EXPECT_EQ(taken, (std::vector<std::uint64_t>{74, 99, 124, 149, 174, 199}));
}

TEST(LooseSchedule, WhatIsLooseLeavesInItsOrderSoManyATick) {
  LooseSchedule schedule;
  const LooseAnswer all = answer(24, {5000, 6000, 7000});
  std::vector<std::uint32_t> left;
  for (std::uint64_t tick = 0; tick < 99; ++tick) {
    const auto voxels = schedule.before_tick(tick, [&] { return &all; });
    EXPECT_LE(voxels.size(), kLeavePerTick);
    if (tick < 74) {
      EXPECT_TRUE(voxels.empty());
    }
    left.insert(left.end(), voxels.begin(), voxels.end());
    EXPECT_EQ(schedule.left(), left.size());
  }
  ASSERT_EQ(left.size(), 18000u);
  for (std::uint32_t i = 0; i < left.size(); ++i) EXPECT_EQ(left[i], i);
}

TEST(LooseSchedule, WhatWasLateIsToldAndPlayedBack) {
  const LooseAnswer first = answer(24, {3}), second = answer(49);
  const auto run = [&](LooseSchedule& schedule, std::uint64_t there_from) {
    std::vector<std::pair<std::uint64_t, std::size_t>> left;
    std::vector<LateAnswer> late;
    int given = 0;
    for (std::uint64_t tick = 0; tick < 120; ++tick) {
      const auto voxels = schedule.before_tick(tick, [&]() -> const LooseAnswer* {
        if (tick < there_from || given == 2) return nullptr;
        return given++ == 0 ? &first : &second;
      });
      if (!voxels.empty()) left.push_back({tick, voxels.size()});
      late.insert(late.end(), schedule.late().begin(), schedule.late().end());
    }
    return std::pair{left, late};
  };
  LooseSchedule slow;
  const auto [left, late] = run(slow, 81);
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].first, 81u);
  ASSERT_EQ(late.size(), 1u) << "the second comes in time";
  EXPECT_EQ(late[0].asked, 24u);
  EXPECT_EQ(late[0].taken, 81u);

  LooseSchedule again(late);
  EXPECT_EQ(run(again, 0).first, left) << "though the answer is there at once";
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
    ASSERT_EQ(found.has_value(), tick == 24 || tick == 49) << tick;
    if (tick == 49) {
      EXPECT_TRUE(found->pieces.empty());
    }
    if (tick != 24) continue;
    EXPECT_EQ(found->asked, 24u);
    ASSERT_EQ(found->pieces.size(), 1u);
    EXPECT_EQ(found->pieces[0].voxels.size(), 6u);
  }
  EXPECT_FALSE(finder.model().solid({16, 5, 5}));
}

}  // namespace
}  // namespace sulcus
