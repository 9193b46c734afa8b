#include "tools/sulcus_lab/ticks/ticks_measurement.hpp"

#include <gtest/gtest.h>

#include "tests/lab/plate_block.hpp"
#include "tools/sulcus_lab/ticks/ticks_floor.hpp"
#include "tools/sulcus_lab/ticks/ticks_sweeps.hpp"

namespace sulcus::lab::ticks_measurement_test {
namespace {

using test::kBlockGround;
using test::plate_block;

const auto kSilent = [](const std::string&) {};

TicksPlan small_plan() {
  TicksPlan plan;
  plan.methods = {NormalMethod::kLdmFast, NormalMethod::kLdm};
  plan.ticks = plan.lead = 60;
  return plan;
}

TEST(TicksMeasurement, EveryMethodWithEveryCache) {
  Workpiece block = plate_block();
  const std::uint64_t before = block.hash();
  constexpr int kWanted = 150;
  std::vector<std::unique_ptr<TicksGroup>> groups;
  groups.push_back(plan_group(block, nullptr, kBlockGround, kWanted, small_plan(), kSilent));
  measure_groups(groups, kSilent);
  const TicksGroup* const group = groups.front().get();
  EXPECT_EQ(block.hash(), before) << "cutting is on copies";
  EXPECT_FALSE(group->pca_ns);
  ASSERT_EQ(group->runs.size(), 6u);
  for (std::size_t m = 0; m < 2; ++m) {
    const TickRun &fresh = group->runs[3 * m], &kept = group->runs[3 * m + 1],
                  &cutting = group->runs[3 * m + 2];
    EXPECT_EQ(fresh.setting.cache, TickCache::kFresh);
    EXPECT_EQ(kept.setting.cache, TickCache::kKept);
    EXPECT_EQ(cutting.setting.cache, TickCache::kCutting);
    EXPECT_EQ(fresh.summary.force_hash, kept.summary.force_hash) << "kept normals are the same";
    EXPECT_NE(fresh.summary.force_hash, cutting.summary.force_hash);
    EXPECT_NEAR(fresh.summary.contacts, kWanted, 0.03 * kWanted);
    EXPECT_NEAR(cutting.summary.contacts, kWanted, 0.1 * kWanted);
    EXPECT_EQ(fresh.summary.removed, 0.0);
    // One voxel in 695 a tick, as far as a short plan finds the energy for it.
    EXPECT_GT(cutting.summary.removed, 0.5 * kWanted / 695);
    EXPECT_GT(cutting.summary.ticks_that_cut, 0.1);
    for (const TickRun* run : {&fresh, &kept, &cutting}) {
      const TickSummary& s = run->summary;
      EXPECT_EQ(s.faults, 0u);
      EXPECT_GT(s.us_mean, 0.0);
      EXPECT_LE(s.us_p50, s.us_p99);
      EXPECT_LE(s.us_p99, s.us_p999);
      EXPECT_LE(s.us_p999, s.us_max);
      EXPECT_LE(s.least, s.contacts);
      EXPECT_GE(s.most, s.contacts);
      EXPECT_GT(run->stages[static_cast<std::size_t>(Stage::kNormals)].us_mean, 0.0);
      const double removal = run->stages[static_cast<std::size_t>(Stage::kRemoval)].us_mean;
      EXPECT_EQ(removal > 0.0, run->setting.cache == TickCache::kCutting);
    }
  }
}

TEST(TicksMeasurement, TheBestIsTheRepetitionWithTheLeastMean) {
  TickSamples slow, fast;
  slow.us = {1.0f, 20.0f, 3.0f};
  fast.us = {4.0f, 5.0f, 6.0f};
  for (TickSamples* samples : {&slow, &fast}) {
    samples->contacts = {10, 20, 30};
    samples->removed = {0, 2, 1};
  }
  TickSummary summary;
  for (const TickSamples* samples : {&slow, &fast, &slow}) summary.keep_best(*samples);
  EXPECT_DOUBLE_EQ(summary.us_mean, 5.0);
  EXPECT_EQ(summary.us_max, 6.0);
  EXPECT_EQ(summary.contacts, 20.0);
  EXPECT_EQ(summary.removed, 1.0);
  EXPECT_DOUBLE_EQ(summary.ticks_that_cut, 2.0 / 3.0);
}

TEST(TicksFloor, FreshNormalsNeedColumnsAndKeptOnesAreRead) {
  const Workpiece block = plate_block();
  const TickPath path = find_tick_path(block, kBlockGround, 150);
  const TickFloor fresh = tick_floor(block, path, 150, true),
                  kept = tick_floor(block, path, 150, false);
  EXPECT_EQ(fresh.kept, 0.0);
  EXPECT_EQ(kept.columns, 0.0);
  EXPECT_EQ(fresh.surface, kept.surface);
  EXPECT_EQ(fresh.field, kept.field);
  // A patch of 150 columns with 6 more around it, about 25 x 25 of them, in one word or two.
  EXPECT_GT(fresh.columns, 4.0 * 20 * 20);
  EXPECT_LT(fresh.columns, 4.0 * 2 * 32 * 32);
  EXPECT_GT(fresh.gb_per_s, 0.1);
  EXPECT_GT(fresh.us, 0.0);
}

TEST(TicksSweeps, TheContactsAreTheSameInEveryGrid) {
  TicksPlan plan = small_plan();
  plan.methods = {NormalMethod::kLdmFast};
  const std::vector<int> grids{64, 96, 128}, contacts{100};
  const std::vector<SweepRow> rows = measure_cells(grids, contacts, plan, kSilent);
  ASSERT_EQ(rows.size(), 6u);
  for (const SweepRow& row : rows) {
    EXPECT_NEAR(row.summary.contacts, 100.0, 3.0);
    EXPECT_EQ(row.summary.contacts, rows.front().summary.contacts);
  }
  EXPECT_GT(growth_of(rows), 0.0);
}

TEST(TicksSweeps, OtherBodiesChangeNothing) {
  TicksPlan plan = small_plan();
  plan.methods = {NormalMethod::kLdmFast};
  Workpiece block = plate_block();
  const std::vector<int> bodies{1, 16};
  const std::vector<SweepRow> rows =
      measure_bodies(block, kBlockGround, bodies, 100, plan, kSilent);
  ASSERT_EQ(rows.size(), 4u);
  for (const SweepRow& row : rows) {
    EXPECT_EQ(row.summary.force_hash, rows.front().summary.force_hash);
  }
}

TEST(TicksSweeps, GrowthIsTheWorstOfTheLargestToTheSmallest) {
  const auto row = [](int size, TickCache cache, double us) {
    SweepRow made;
    made.size = size;
    made.setting.cache = cache;
    made.summary.us_mean = us;
    return made;
  };
  const std::vector<SweepRow> rows{row(1, TickCache::kFresh, 10), row(2, TickCache::kFresh, 90),
                                   row(4, TickCache::kFresh, 11), row(1, TickCache::kKept, 2),
                                   row(2, TickCache::kKept, 2),   row(4, TickCache::kKept, 3)};
  EXPECT_DOUBLE_EQ(growth_of(rows), 1.5);
}

}  // namespace
}  // namespace sulcus::lab::ticks_measurement_test
