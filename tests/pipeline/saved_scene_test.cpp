// "Save as a scene": what was done by a hand is done again, by the recording alone.
#include "app/playback/saved_scene.hpp"

#include <cstring>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "engine/recording/recording_reader.hpp"
#include "engine/scene/scene_file.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::saved_scene_test {
namespace {

/// A hand that presses into a block and cuts it, and rests at the end.
const std::string kHandScene = test::block_and_burr() + R"(
[trajectory]
points_mm = [[0, 0, 1.5], [0, 0, 0.5], [0.3, 0, 0.5]]
speed_mm_per_s = 10
hold_s = 0.3
[device]
model = "simulated"
preset = "omni"
hand = "firm"
push_N = 1
push_ramp_s = 0.1
silent_s = [[0.2, 0.22]]
[coupling]
[cutting]
[record]
)";

class SavedScenes : public testing::Test {
 protected:
  void run(const std::string& scene, const std::string& folder) {
    const auto result =
        test::sulcus_command("run " + scene + " -o " + scratch_.path(folder), scratch_.path("err"));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  /// Runs a scene as if by a hand, saves that as a scene beside it and runs this.
  void expect_the_same_again(const std::string& text) {
    run(scratch_.write("by_hand.toml", text), "hand");
    const std::string recording = scratch_.path("hand/recording.h5");
    const RecordingReader hand(recording);
    const Scene scene = parse_scene(hand.header().scene_toml, scratch_.path("by_hand.toml"));
    run(scratch_.write("hand/scene.toml", saved_scene(scene, recording, {})), "again");
    const RecordingReader again(scratch_.path("again/recording.h5"));
    ASSERT_EQ(again.tick_count(), hand.tick_count());
    ASSERT_GT(hand.edit_count(), 20u);
    ASSERT_EQ(again.edit_count(), hand.edit_count());
    const auto edits = hand.edits(), edits_again = again.edits();
    for (std::size_t i = 0; i < edits.size(); ++i) {
      ASSERT_EQ(edits_again[i].voxel, edits[i].voxel) << i;
      ASSERT_EQ(edits_again[i].tick, edits[i].tick) << i;
    }
    const auto rows = hand.ticks(), rows_again = again.ticks();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      ASSERT_EQ(std::memcmp(rows_again[i].force_N, rows[i].force_N, sizeof rows[i].force_N), 0)
          << i;
    }
  }
  const ScratchFolder scratch_;
};

TEST_F(SavedScenes, WhatAHandDidBehindADeviceIsDoneAgain) { expect_the_same_again(kHandScene); }

TEST_F(SavedScenes, WithoutADeviceItIsTheSameToTheBit) {
  std::string text = kHandScene;
  const std::size_t device = text.find("[device]");
  text.erase(device, text.find("[coupling]") - device);
  expect_the_same_again(text);
}

TEST_F(SavedScenes, APlugInIsNotNeededAgain) {
  const Scene scene =
      parse_scene(test::block_and_burr() +
                      "[trajectory]\npoints_mm = [[0, 0, 1.5]]\n[device]\nplugin = 'mine'\n"
                      "stiffness_N_per_mm = 1.3\nforce_limit_N = 4\n[coupling]\n[record]\n",
                  "s.toml");
  const Scene saved = parse_scene(saved_scene(scene, "/out/recording.h5", {}), "/out/scene.toml");
  ASSERT_TRUE(saved.device);
  EXPECT_FALSE(saved.device->plugin);
  EXPECT_TRUE(saved.device->played_back);
  EXPECT_EQ(saved.device->force_limit_N, 4.0);
  EXPECT_NEAR(saved.coupling->stiffness_N_per_m, 1300.0, 1e-9);
  EXPECT_EQ(saved.coupling->force_limit_N, scene.coupling->force_limit_N);
}

TEST_F(SavedScenes, PathsAreRelativeAndNumbersShort) {
  std::string text = "title = \"of 0.034799999999999998 mm\"\n" + kHandScene;
  const std::string voxel = "voxel_mm = 0.05";
  text.replace(text.find(voxel), voxel.size(), "voxel_mm = 0.0348");
  text += "[goal]\nfile = 'goals/box.stl'\n";
  const Scene scene = parse_scene(text, "/dental/scenes/s.toml");
  const std::string saved = saved_scene(scene, "/dental/out/s_view/recording.h5", Section{1, 2e-4});
  EXPECT_NE(saved.find("voxel_mm = 0.0348\n"), std::string::npos) << saved;
  EXPECT_NE(saved.find("of 0.034799999999999998 mm"), std::string::npos)
      << "texts stay as they are: " << saved;
  EXPECT_NE(saved.find("y=0.2"), std::string::npos) << saved;
  EXPECT_EQ(saved.find("/work"), std::string::npos) << saved;
  // Moved together with what they name.
  const Scene moved = parse_scene(saved, "/home/out/s_view/scene.toml");
  EXPECT_EQ(moved.trajectory.recording, "/home/out/s_view/recording.h5");
  EXPECT_EQ(std::filesystem::path(moved.goal->file).lexically_normal(),
            "/home/scenes/goals/box.stl");
  EXPECT_EQ(moved.workpiece.voxel_m, scene.workpiece.voxel_m);
}

}  // namespace
}  // namespace sulcus::saved_scene_test
