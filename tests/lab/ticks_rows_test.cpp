#include "tools/sulcus_lab/ticks/ticks_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab::ticks_rows_test {
namespace {

TickRow row(NormalMethod method, TickCache cache, int contacts, double us, double pca_us) {
  TickRow made;
  made.setting = {method, cache};
  made.wanted = contacts;
  made.summary.contacts = contacts;
  made.summary.us_mean = us;
  made.summary.us_p50 = 0.9 * us;
  made.summary.us_p99 = 2.0 * us;
  made.summary.us_p999 = 4.5 * us;
  made.pca_us = pca_us;
  return made;
}

const TickRatio* ratio(const std::vector<TickRatio>& ratios, const std::string& what) {
  for (const TickRatio& r : ratios) {
    if (r.what == what) return &r;
  }
  return nullptr;
}

TEST(TickRatios, AreThoseOfTheIssue) {
  const std::vector<TickRow> rows{
      row(NormalMethod::kLdmFast, TickCache::kFresh, 1000, 100, 5000),
      row(NormalMethod::kLdmFast, TickCache::kFresh, 10000, 1100, 55000),
      row(NormalMethod::kLdmFast, TickCache::kCutting, 10000, 500, 55000),
      row(NormalMethod::kLdmFast, TickCache::kCutting, 350, 70, 2100)};
  const std::vector<TickRatio> ratios = tick_ratios(rows, {}, {});
  ASSERT_EQ(ratios.size(), 5u);
  const TickRatio* fresh = ratio(ratios, "1: PCA / mean at 10,000, ldm_fast, fresh");
  ASSERT_TRUE(fresh);
  EXPECT_DOUBLE_EQ(fresh->value, 50.0);
  EXPECT_FALSE(fresh->met());
  const TickRatio* cutting = ratio(ratios, "2: PCA / p99 at 10,000, ldm_fast, cutting");
  ASSERT_TRUE(cutting);
  EXPECT_DOUBLE_EQ(cutting->value, 55.0);
  EXPECT_TRUE(cutting->met());
  const TickRatio* tail = ratio(ratios, "2: p99.9 / median at 10,000, ldm_fast, cutting");
  ASSERT_TRUE(tail);
  EXPECT_DOUBLE_EQ(tail->value, 5.0);
  EXPECT_TRUE(tail->met());
  const TickRatio* few = ratio(ratios, "3: PCA / mean at 350, ldm_fast, cutting");
  ASSERT_TRUE(few);
  EXPECT_DOUBLE_EQ(few->value, 30.0);
  EXPECT_TRUE(few->met());
  const TickRatio* cost = ratio(ratios, "4: time per contact, 10000 to 1000, ldm_fast, fresh");
  ASSERT_TRUE(cost);
  EXPECT_DOUBLE_EQ(cost->value, 1.1);
  EXPECT_FALSE(cost->met());
}

TEST(TickRatios, WithoutPclOnlyThoseOfOurOwnTimes) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<TickRow> rows{row(NormalMethod::kLdm, TickCache::kFresh, 10000, 1000, none),
                                  row(NormalMethod::kLdm, TickCache::kCutting, 10000, 500, none)};
  const std::vector<TickRatio> ratios = tick_ratios(rows, {}, {});
  ASSERT_EQ(ratios.size(), 1u);
  EXPECT_EQ(ratios.front().what, "2: p99.9 / median at 10,000, ldm, cutting");
  EXPECT_EQ(found_line(rows.front()).substr(found_line(rows.front()).size() - 3), ",,,");
}

TEST(TickRows, LinesHoldWhatTheirHeadersSay) {
  TickRow made = row(NormalMethod::kLdmFast, TickCache::kKept, 350, 12.5, 700);
  made.summary.us_max = 30.25;
  EXPECT_EQ(ticks_line(made), "ldm_fast,kept,350,12.500,11.250,25.000,30.250");
  made.stages[2] = {7.5, 9.25};
  const std::vector<std::string> stages = stage_lines(made);
  ASSERT_EQ(stages.size(), static_cast<std::size_t>(kStageCount));
  EXPECT_EQ(stages[2], "ldm_fast,kept,350,normals,7.500,9.250");

  const auto columns = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  EXPECT_EQ(columns(ticks_line(made)), columns(kTicksHeader));
  EXPECT_EQ(columns(stages[0]), columns(kStagesHeader));
  EXPECT_EQ(columns(found_line(made)), columns(kFoundHeader));
  EXPECT_EQ(columns(sweep_line({})), columns(kSweepColumns));
  for (const std::string& line : floor_lines({})) EXPECT_EQ(columns(line), columns(kFloorHeader));
}

TEST(LogSlope, LeavesOutWhatHasNoLogarithm) {
  EXPECT_NEAR(log_slope({{1, 3}, {2, 12}, {4, 48}, {8, 0}, {8, NAN}}), 2.0, 1e-12);
}

}  // namespace
}  // namespace sulcus::lab::ticks_rows_test
