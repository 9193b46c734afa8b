#include "tools/sulcus_lab/recordings/recording_trials.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace sulcus::lab::recording_trials_test {
namespace {

class RecordingTrials : public ::testing::Test {
 protected:
  TrialSetting setting() const {
    return {.program = SULCUS_PROGRAM,
            .folder = scratch_.path("."),
            .kills = 4,
            .flips = 40,
            .cut_bytes = 60,
            .ticks = 250};
  }
  static double value(const std::vector<TrialRow>& rows, const std::string& quantity) {
    const auto row = std::ranges::find(rows, quantity, &TrialRow::quantity);
    return row == rows.end() ? -1.0 : row->value;
  }
  /// All but what is the machine's.
  static void expect_passed(const std::vector<TrialRow>& rows) {
    for (const TrialRow& row : rows) {
      if (row.quantity == "missing_ms largest") continue;
      EXPECT_TRUE(row.pass()) << row.quantity << ' ' << row.value;
    }
  }

  ScratchFolder scratch_;
};

TEST_F(RecordingTrials, KilledRunsAreRepaired) {
  const auto rows = trial_of_kills(setting());
  expect_passed(rows);
  EXPECT_EQ(value(rows, "killed") + value(rows, "ended before"), 4.0);
}

TEST_F(RecordingTrials, CutAndFlippedFilesNeverLie) {
  const auto cuts = trial_of_cuts(setting()), flips = trial_of_flips(setting());
  expect_passed(cuts);
  expect_passed(flips);
  EXPECT_EQ(value(cuts, "files"), 60.0);
  EXPECT_EQ(value(flips, "files"), 40.0);
}

TEST_F(RecordingTrials, GoingBackMeetsTheHashesOfTheWayOn) {
  const auto rows = trial_of_going_back(setting());
  expect_passed(rows);
  EXPECT_NEAR(value(rows, "ticks"), 250.0, 5.0);
  EXPECT_GT(value(rows, "removed voxels"), 10.0);
}

}  // namespace
}  // namespace sulcus::lab::recording_trials_test
