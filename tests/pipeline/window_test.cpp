// What mouse and keys do in a window: xdotool is the hand.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/x_display.hpp"

namespace sulcus::window_test {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;

/// From the side: what is down in the picture is down in the world. (A function: what a header
/// defines may be initialised after what is defined here.)
std::string seen_from_buccal() { return test::cut_scene() + "[render]\ncamera = \"buccal\"\n"; }

class HandInWindow : public testing::Test {
 protected:
  void SetUp() override { ASSERT_FALSE(display_.number().empty()) << "Xvfb does not start"; }

  /// Opens a window, and once `file` is there does what the script says; then waits for its end.
  /// `first`: commands of the shell that starts the program.
  CommandResult view(const std::string& arguments, const std::string& file,
                     const std::string& script, const std::string& first = "") {
    const std::string path = scratch_.write(
        "script", "[ -x \"$(command -v xdotool)\" ] || exit 77\n(" + first + "exec " +
                      SULCUS_PROGRAM + " view " + arguments + ") &\nprogram=$!\n" +
                      "for i in $(seq 300); do [ -e " + file + " ] && break; sleep 0.1; done\n" +
                      "for i in $(seq 300); do xdotool search --onlyvisible --name Sulcus "
                      ">/dev/null 2>&1 && break; sleep 0.1; done\nsleep 2\n" +
                      script + "\nwait $program\n");
    return test::program_command(
        "bash", path, scratch_.path("stderr"),
        "DISPLAY=:" + display_.number() + " SULCUS_CACHE=off ASAN_OPTIONS=detect_leaks=0");
  }
  CommandResult view_scene(const std::string& script) {
    out_ = scratch_.path("out");
    const std::string scene = scratch_.write("s.toml", seen_from_buccal());
    return view(scene + " -o " + out_, out_ + "/recording.h5", script);
  }
  /// Of a scene with another burr, to which the key b changes.
  CommandResult view_with_burrs(const std::string& script, const std::string& first = "") {
    out_ = scratch_.path("out");
    const std::string scene = scratch_.write(
        "s.toml", seen_from_buccal() +
                      "[[spare_burr]]\nname = \"large\"\nshape = \"round\"\ndiameter_mm = 1.0\n");
    return view(scene + " -o " + out_, out_ + "/recording.h5", script, first);
  }
  void expect_whole() const {
    EXPECT_TRUE(fs::exists(out_ + "/summary.json"));
    const CommandResult verified =
        test::sulcus_command("replay " + out_ + "/recording.h5 --verify", scratch_.path("stderr"));
    EXPECT_EQ(verified.status, 0) << verified.err;
  }

  ScratchFolder scratch_;
  test::XDisplay display_{"1300x760x24"};
  std::string out_;
};

TEST_F(HandInWindow, ABurrThatIsLetGoIsLiftedOffAndCutsNoMore) {
  const CommandResult result = view_scene(R"(
xdotool mousemove 640 250 mousedown 1
for i in $(seq 40); do xdotool mousemove_relative 0 5; sleep 0.03; done
sleep 0.7
xdotool mouseup 1
sleep 2
xdotool key Escape)");
  ASSERT_EQ(result.status, 0) << result.err;
  const RecordingReader reader(out_ + "/recording.h5");
  const std::vector<TickRecord> rows = reader.ticks();
  ASSERT_GT(rows.size(), 2500u);
  EXPECT_GT(rows.back().edits_end, 100u) << "it has cut";
  const TickRecord& before_end = rows[rows.size() - 1000];
  EXPECT_EQ(rows.back().edits_end, before_end.edits_end);
  double lowest = 1.0;
  for (const TickRecord& row : rows) lowest = std::min(lowest, row.device_position_m[2]);
  EXPECT_GT(rows.back().device_position_m[2], lowest + 0.3e-3);
  EXPECT_EQ(rows.back().contacts, 0u);
  // Along its axis, which points up here.
  const auto deepest = std::ranges::min_element(
      rows, {}, [](const TickRecord& row) { return row.device_position_m[2]; });
  EXPECT_NEAR(rows.back().device_position_m[1], deepest->device_position_m[1], 0.1e-3);
  expect_whole();
}

TEST_F(HandInWindow, AWindowThatIsDestroyedKeepsWhatWasDone) {
  for (const char* end : {"windowclose", "windowkill"}) {
    const CommandResult result =
        view_scene(std::string("xdotool search --onlyvisible --name Sulcus ") + end);
    EXPECT_EQ(result.status, 0) << end << ": " << result.err;
    expect_whole();
    fs::remove_all(out_);
  }
}

TEST_F(HandInWindow, ADisplayThatBreaksDownKeepsWhatWasDone) {
  const CommandResult result =
      view_scene("kill " + std::to_string(static_cast<long>(display_.process())));
  EXPECT_EQ(result.status, 0) << result.err;
  expect_whole();
}

TEST_F(HandInWindow, ARecordingThatEndsBeforeTheRunIsSaidAtOnceAndNothingGoesOnFromIt) {
  const CommandResult result = view_with_burrs(R"(
for i in $(seq 300); do grep -q "ends before the run" )" +
                                                   scratch_.path("out/log.txt") +
                                                   R"( && break; sleep 0.1; done
xdotool key b
sleep 2
kill -0 $program && touch )" + scratch_.path("lasts") +
                                                   "\nxdotool key Escape",
                                               "ulimit -f 300; ");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(test::read_file(out_ + "/log.txt").find("File too large"), std::string::npos);
  EXPECT_TRUE(fs::exists(scratch_.path("lasts"))) << result.err;
  EXPECT_FALSE(fs::exists(out_ + "/part_2"));
  EXPECT_TRUE(fs::exists(out_ + "/summary.json"));
}

TEST_F(HandInWindow, WithoutItsRecordingARunGoesOnAsItIs) {
  const CommandResult result =
      view_with_burrs("rm " + scratch_.path("out/recording.h5") +
                      "\nxdotool key b\nsleep 2\nkill -0 $program && touch " +
                      scratch_.path("lasts") + "\nxdotool key Escape");
  EXPECT_TRUE(fs::exists(scratch_.path("lasts"))) << result.err;
  EXPECT_FALSE(fs::exists(out_ + "/part_2"));
}

TEST_F(HandInWindow, APartWhoseNameIsTakenHasTheNextOne) {
  const CommandResult result = view_with_burrs(
      "touch " + scratch_.path("out/part_2") + "\nxdotool key b\nfor i in $(seq 100); do [ -e " +
      scratch_.path("out/part_2-2/recording.h5") +
      " ] && break; sleep 0.1; done\nsleep 1\nxdotool key Escape");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(fs::exists(out_ + "/part_2-2/summary.json"));
  expect_whole();
}

TEST_F(HandInWindow, ASceneMayBeAPipeAndItsWindowWiderThanAPictureCanBe) {
  const std::string scene = scratch_.write("s.toml", seen_from_buccal());
  const std::string pipe = scratch_.path("pipe.toml");
  out_ = scratch_.path("out");
  const CommandResult result =
      view(pipe + " -o " + out_, out_ + "/recording.h5",
           "xdotool search --onlyvisible --name Sulcus windowsize 17000 20\nsleep 2\n"
           "xdotool key Escape",
           "mkfifo " + pipe + "; (cat " + scene + " > " + pipe + " &); ");
  EXPECT_EQ(result.status, 0) << result.err;
  expect_whole();
}

TEST_F(HandInWindow, CopiesThePlaceUnderThePointerAndIsEndedByAKey) {
  const std::string copied = scratch_.path("copied");
  const std::string scene = scratch_.write("s.toml", seen_from_buccal());
  out_ = scratch_.path("out");
  ASSERT_EQ(
      test::sulcus_command("run --no-render " + scene + " -o " + out_, scratch_.path("stderr"))
          .status,
      0);
  const CommandResult result = view(out_ + "/recording.h5", out_ + "/recording.h5",
                                    "xdotool key 2 mousemove 700 420\nsleep 1\nxdotool key c\n"
                                    "sleep 0.5\ntimeout 5 xclip -o -selection clipboard > " +
                                        copied + "\nxdotool key q");
  EXPECT_EQ(result.status, 0) << result.err;
  double x = 0.0, y = 0.0, z = 0.0;
  const std::string text = test::read_file(copied);
  ASSERT_EQ(std::sscanf(text.c_str(), "[%lf, %lf, %lf]", &x, &y, &z), 3) << text;
  // On the face of the block towards buccal, to the right of its middle and below it.
  EXPECT_NEAR(y, -1.0, 0.051);
  EXPECT_GT(x, 0.05);
  EXPECT_LT(x, 1.0);
  EXPECT_LT(z, -0.05);
  EXPECT_GT(z, -1.0);
}

}  // namespace
}  // namespace sulcus::window_test
