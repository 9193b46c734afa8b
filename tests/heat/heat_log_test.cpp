#include "engine/heat/heat_log.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::heat_log_test {
namespace {

struct Row {
  TickRecord tick;
  CuttingRecord cutting;
};

/// Rows of ticks `first` to before `end`; each has done 2 J more than the one before.
std::vector<Row> rows_of(std::uint64_t first, std::uint64_t end) {
  std::vector<Row> rows;
  for (std::uint64_t tick = first; tick < end; ++tick) {
    Row& row = rows.emplace_back();
    row.tick.tick = row.cutting.tick = tick;
    row.tick.tool_position_m[0] = 1e-3 * static_cast<double>(tick);
    row.cutting.spindle_rad_per_s = 1e3;
    row.cutting.work_J = 2.0 * static_cast<double>(tick + 1);
  }
  return rows;
}

Edit cut_in(std::uint64_t tick, std::uint32_t voxel) {
  return {tick, voxel, 0, EditCause::kCut, 0};
}

void expect_equal(const HeatLog& a, const HeatLog& b) {
  ASSERT_EQ(a.stretches().size(), b.stretches().size());
  for (std::size_t i = 0; i < a.stretches().size(); ++i) {
    const HeatLog::Stretch &left = a.stretches()[i], &right = b.stretches()[i];
    EXPECT_EQ(left.work_J, right.work_J) << i;
    EXPECT_EQ(left.has_rows, right.has_rows) << i;
    EXPECT_EQ(left.turns, right.turns) << i;
    EXPECT_EQ(left.tip_world, right.tip_world) << i;
  }
  ASSERT_EQ(a.gone().size(), b.gone().size());
  for (std::size_t i = 0; i < a.gone().size(); ++i) {
    EXPECT_EQ(a.gone()[i].stretch, b.gone()[i].stretch);
    EXPECT_EQ(a.gone()[i].voxel, b.gone()[i].voxel);
  }
}

TEST(HeatLog, AStretchHasTheWorkOfItsTicks) {
  HeatLog log(1000.0, 0);
  for (const Row& row : rows_of(0, 25)) log.add(row.tick, row.cutting);
  ASSERT_EQ(log.stretches().size(), 3u);
  EXPECT_EQ(log.stretch_s(), 0.01);
  EXPECT_DOUBLE_EQ(log.stretches()[0].work_J, 20.0);
  EXPECT_DOUBLE_EQ(log.stretches()[1].work_J, 20.0);
  EXPECT_DOUBLE_EQ(log.stretches()[2].work_J, 10.0);
  EXPECT_DOUBLE_EQ(log.stretches()[0].tip_world.x(), 9e-3);
  EXPECT_TRUE(log.stretches()[1].turns);
  EXPECT_DOUBLE_EQ(log.end_s(1), 0.02);
}

TEST(HeatLog, EditsMayComeBeforeTheirRows) {
  const std::vector<Row> rows = rows_of(0, 60);
  HeatLog after(1000.0, 0), before(1000.0, 0);
  const std::vector<Edit> edits{cut_in(7, 3), cut_in(31, 4), cut_in(55, 5)};
  for (const Row& row : rows) after.add(row.tick, row.cutting);
  for (const Edit& edit : edits) after.add(edit);
  for (const Edit& edit : edits) before.add(edit);
  for (const Row& row : rows) before.add(row.tick, row.cutting);
  expect_equal(after, before);
  EXPECT_EQ(after.gone()[1].stretch, 3u);
}

TEST(HeatLog, ALevelThatFallsIsNoVoxelThatGoes) {
  HeatLog log(1000.0, 0);
  log.add(Edit{3, 9, 0, EditCause::kCut, 100});
  EXPECT_TRUE(log.gone().empty());
}

TEST(HeatLog, WorkIsThereThatWasDoneWhereRowsAreMissing) {
  HeatLog log(1000.0, 0);
  double work_J = 0.0;
  for (const Row& row : rows_of(0, 100)) {
    if (row.tick.tick >= 35 && row.tick.tick < 72) continue;
    log.add(row.tick, row.cutting);
  }
  for (const HeatLog::Stretch& stretch : log.stretches()) work_J += stretch.work_J;
  EXPECT_DOUBLE_EQ(work_J, 200.0);
  EXPECT_FALSE(log.stretches()[5].has_rows);
}

// Of a run that goes on from another: what was done before it is none of its own.
TEST(HeatLog, GoesOnInTheMiddleOfAClock) {
  HeatLog log(1000.0, 503);
  for (const Row& row : rows_of(503, 533)) log.add(row.tick, row.cutting);
  ASSERT_EQ(log.stretches().size(), 3u);
  EXPECT_DOUBLE_EQ(log.end_s(0), 0.513);
  EXPECT_DOUBLE_EQ(log.stretches()[0].work_J, 18.0);  // its first tick's is not known
  EXPECT_DOUBLE_EQ(log.stretches()[1].work_J, 20.0);
}

TEST(HeatLog, AStretchIsAtLeastATick) {
  HeatLog log(10.0, 0);
  EXPECT_DOUBLE_EQ(log.stretch_s(), 0.1);
}

}  // namespace
}  // namespace sulcus::heat_log_test
