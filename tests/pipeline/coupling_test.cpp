#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/energy_balance.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::coupling_test {
namespace {

using test::sulcus_command;

/// A hand that presses on a block through a device and a coupling.
const std::string kPressScene = test::block_and_burr() + R"(
[trajectory]
points_mm = [[0, 0, 1.5], [0, 0, -0.4]]
speed_mm_per_s = 20
hold_s = 0.6
[device]
model = "simulated"
preset = "omni"
hand = "firm"
push_N = 1
push_ramp_s = 0.1
delay_ticks = 1
late_s = [[0.3, 0.008]]
silent_s = [[0.5, 0.54]]
passivity_controller = true
[coupling]
[record]
)";

class Coupled : public ::testing::Test {
 protected:
  nlohmann::json run(const std::string& scene_text, const std::string& name,
                     const std::string& options = {}) {
    const std::string scene = scratch_.write(name + ".toml", scene_text);
    const auto result = sulcus_command(
        "run " + scene + " " + options + " -o " + scratch_.path(name), scratch_.path("err"));
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(test::read_file(scratch_.path(name) + "/summary.json"));
  }
  test::CommandResult verify(const std::string& name) {
    return sulcus_command("replay --verify " + scratch_.path(name) + "/recording.h5",
                          scratch_.path("err"));
  }
  const ScratchFolder scratch_;
};

TEST_F(Coupled, AHandPressesAndTheToolStaysOutAtAnyPaceWithTheSameBits) {
  const nlohmann::json summary = run(kPressScene, "fast");
  EXPECT_EQ(summary["device"]["silent_ticks"], 21);
  EXPECT_EQ(summary["device"]["bridged_ticks"], 20);
  EXPECT_GT(summary["coupling"]["evaluations"]["mean"].get<double>(), 1.0);
  EXPECT_EQ(summary["faults"]["device_silent"], 21);
  EXPECT_EQ(summary["buzz_ticks"], 0);

  const RecordingReader reader(scratch_.path("fast/recording.h5"));
  const auto ticks = reader.ticks();
  const auto port = reader.port();
  ASSERT_EQ(port.size(), ticks.size());
  double deepest_m = 0.0, largest_N = 0.0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    deepest_m = std::max(deepest_m, 1e-3 - ticks[i].tool_position_m[2]);
    const double asked_N =
        std::hypot(port[i].asked_force_N[0], port[i].asked_force_N[1], port[i].asked_force_N[2]);
    largest_N = std::max(largest_N, asked_N);
    // What is asked for is the springs' pull, 700 N/m, through the middle of the head.
    const double stretch_m =
        std::hypot(ticks[i].tool_position_m[0] - ticks[i].device_position_m[0],
                   ticks[i].tool_position_m[1] - ticks[i].device_position_m[1],
                   ticks[i].tool_position_m[2] - ticks[i].device_position_m[2]);
    ASSERT_NEAR(asked_N, std::min(3.3, 700.0 * stretch_m), 0.01 * asked_N + 1e-6) << i;
  }
  EXPECT_GT(largest_N, 0.7);
  EXPECT_LT(deepest_m, 1.5 * 50e-6);
  const auto verified = verify("fast");
  EXPECT_EQ(verified.status, 0) << verified.err;

  const nlohmann::json paced = run(kPressScene, "real", "--pace real");
  EXPECT_EQ(paced["force_hash"], summary["force_hash"]);
}

TEST_F(Coupled, CuttingThroughACouplingKeepsItsBooksAndReplays) {
  const nlohmann::json summary = run(kPressScene + "[cutting]\n", "cut");
  EXPECT_GT(summary["removed_voxels"].get<int>(), 500);
  test::expect_energies_balance(summary);
  const auto verified = verify("cut");
  EXPECT_EQ(verified.status, 0) << verified.err;
}

TEST_F(Coupled, WhatASceneDoesNotNameIsNeitherInItsSummaryNorInItsRecording) {
  const nlohmann::json plain = run(test::cut_scene(), "plain");
  EXPECT_FALSE(plain.contains("coupling"));
  EXPECT_FALSE(plain.contains("device"));
  EXPECT_TRUE(plain.contains("passivity")) << "the observer is always there";
  EXPECT_TRUE(RecordingReader(scratch_.path("plain/recording.h5")).port().empty());
}

}  // namespace
}  // namespace sulcus::coupling_test
