#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

// What a run says of poses that do not come, that jump, or that go too far.

namespace sulcus::faults_test {
namespace {

using test::sulcus_command;

class Faults : public ::testing::Test {
 protected:
  test::CommandResult run(const std::string& scene_text) {
    const std::string scene = scratch_.write("s.toml", scene_text);
    return sulcus_command("run " + scene + " --force -o " + scratch_.path("out"),
                          scratch_.path("err"));
  }
  /// Poses of an upright tool: time in s, x and z in mm.
  void write_table(const std::vector<std::array<double, 3>>& rows) {
    std::string text = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
    for (const auto& [time_s, x_mm, z_mm] : rows) {
      text += std::to_string(time_s) + "," + std::to_string(x_mm) + ",0," + std::to_string(z_mm) +
              ",0.70710678,0.70710678,0,0\n";
    }
    scratch_.write("poses.csv", text);
  }
  nlohmann::json summary() const {
    return nlohmann::json::parse(test::read_file(scratch_.path("out/summary.json")));
  }
  std::vector<TickRecord> ticks() const {
    return RecordingReader(scratch_.path("out/recording.h5")).ticks();
  }
  const ScratchFolder scratch_;
};

const std::string kTableScene = test::block_and_burr() + R"(
[trajectory]
file = "poses.csv"
[cutting]
[record]
)";

TEST_F(Faults, ThePosesOfATableAreAllEvaluatedTheLastTooWhateverTheRate) {
  write_table({{0, 0, 1.5}, {0.1, 0, 1.3}, {0.2005, 0.4, 1.2}});
  for (const std::string rate_hz : {"1000", "300"}) {
    ASSERT_EQ(run(kTableScene + "[haptics]\nrate_hz = " + rate_hz + "\n").status, 0);
    const TickRecord last = ticks().back();
    EXPECT_NEAR(last.tool_position_m[0], 0.4e-3, 1e-12);
    EXPECT_NEAR(last.tool_position_m[2], 1.2e-3, 1e-12);
    const double over_s = last.time_s - 0.2005;
    EXPECT_TRUE(over_s >= 0.0 && over_s < 1.0 / std::stod(rate_hz)) << "and no more";
  }
}

TEST_F(Faults, AJumpIntoTheBlockCutsNothingAndIsTold) {
  write_table({{0, -19, 1.2}, {0.05, -19, 1.2}, {0.051, 0, 0.8}, {0.052, 0, 0.8}, {0.1, 0, 0.8}});
  const auto jumped = run(kTableScene);
  ASSERT_EQ(jumped.status, 0) << jumped.err;
  EXPECT_NE(jumped.err.find("fault device_jumped in 1 ticks"), std::string::npos) << jumped.err;
  const auto rows = ticks();
  EXPECT_EQ(rows[51].faults, kFaultDeviceJumped);
  EXPECT_GT(rows[51].contacts, 0u);
  EXPECT_EQ(rows[51].removed, 0u);
  EXPECT_GT(summary()["removed_voxels"], 0) << "it cuts once it is there";
}

TEST_F(Faults, AStepTooLongForWhatItMeetsIsALineAtTheEnd) {
  write_table({{0, 0, 2.5}, {0.01, 0, 2.5}, {0.011, 0, 0.7}, {0.1, 0, 0.7}});
  const auto result = run(kTableScene);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("fault step_too_long in 1 ticks"), std::string::npos) << result.err;
  EXPECT_EQ(summary()["faults"]["step_too_long"], 1);
}

TEST_F(Faults, StepsTooLongToCutAllTheyPassAreALineAtTheEnd) {
  // Into the block in 0.2 s; then along it in steps of 4 voxels, of which the burr goes in by 3 at
  // its rim.
  write_table({{0, -0.8, 1.2}, {0.2, -0.8, 0.9}, {0.208, 0.8, 0.9}, {0.3, 0.8, 0.9}});
  const auto result = run(kTableScene);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("fault step_too_long in 8 ticks"), std::string::npos) << result.err;
  EXPECT_EQ(summary()["faults"]["step_too_long"], 8);
}

TEST_F(Faults, VoxelsTooCoarseForTheBurrAreSaid) {
  for (const std::string voxel_mm : {"10", "1"}) {
    const auto result =
        run("[workpiece]\nshape = 'box'\ncells = [48, 48, 48]\nvoxel_mm = " + voxel_mm + R"(
box.size_mm = [40, 40, 40]
[burr]
diameter_mm = 5
speed_rpm = 0
[trajectory]
points_mm = [[0, 0, 22], [0, 0, 21]]
speed_mm_per_s = 50
)");
    ASSERT_EQ(result.status, 0) << result.err;
    const bool said =
        result.err.find("voxels of 10 mm, too coarse for a burr of 5") != std::string::npos;
    EXPECT_EQ(said, voxel_mm == "10") << result.err;
  }
}

TEST_F(Faults, WhatASilentDeviceLeavesBehindIsTheSameAgain) {
  const auto result = run(test::block_and_burr() + R"(
[trajectory]
points_mm = [[0, 0, 1.2], [0, 0, 0.6]]
speed_mm_per_s = 4
hold_s = 0.4
[device]
model = "simulated"
hand = "firm"
push_N = 1
silent_s = [[0.2, 0.205], [0.25, 0.45]]
[coupling]
[cutting]
[record]
[[tissue]]
name = "dentine"
)");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(summary()["faults"]["pose_bridged"], 6 + 20);
  EXPECT_EQ(summary()["faults"]["device_silent"], 201 - 20);
  const auto rows = ticks();
  std::uint32_t in_silence = 0, bridged = 0;
  for (const TickRecord& row : rows) {
    if (row.faults & kFaultDeviceSilent) in_silence += row.removed;
    if (row.faults & kFaultPoseBridged) bridged += row.removed;
  }
  EXPECT_EQ(in_silence, 0u);
  EXPECT_GT(bridged, 0u);
  const auto verified =
      sulcus_command("replay --verify " + scratch_.path("out/recording.h5"), scratch_.path("err"));
  EXPECT_EQ(verified.status, 0) << verified.err;
}

}  // namespace
}  // namespace sulcus::faults_test
