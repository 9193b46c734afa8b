// The window, on a display without a screen.

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/x_display.hpp"

namespace sulcus::view_test {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;

class View : public testing::Test {
 protected:
  void SetUp() override { ASSERT_FALSE(display_.number().empty()) << "Xvfb does not start"; }

  /// Opens a window and stops it a second after `file` is there.
  CommandResult view_and_stop(const std::string& arguments, const std::string& file,
                              const std::string& signal) {
    const std::string script = scratch_.write(
        "script", std::string(SULCUS_PROGRAM) + " view " + arguments + " &\n" +
                      "for i in $(seq 300); do [ -e " + file + " ] && break; sleep 0.1; done\n" +
                      "sleep 1\nkill -" + signal + " $!\nwait $!\n");
    // What a driver leaks that has been unloaded by the end has no name to suppress it by.
    return test::program_command(
        "bash", script, scratch_.path("stderr"),
        "DISPLAY=:" + display_.number() + " SULCUS_CACHE=off ASAN_OPTIONS=detect_leaks=0");
  }

  ScratchFolder scratch_;
  test::XDisplay display_;
};

TEST_F(View, AStoppedSessionOfTheHandKeepsWhatWasDone) {
  const std::string scene = scratch_.write("s.toml", test::cut_scene()), out = scratch_.path("out");
  const CommandResult result = view_and_stop(scene + " -o " + out, out + "/recording.h5", "TERM");
  EXPECT_EQ(result.status, 143) << result.err;
  EXPECT_NE(result.err.find("stopped on request after"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find(out + "/recording.h5"), std::string::npos) << result.out;
  EXPECT_TRUE(fs::exists(out + "/summary.json"));
  const CommandResult verified =
      test::sulcus_command("replay " + out + "/recording.h5 --verify", scratch_.path("stderr"));
  EXPECT_EQ(verified.status, 0) << verified.err;
}

TEST_F(View, AWindowOnARecordingIsStoppedAtOnce) {
  const std::string scene = scratch_.write("s.toml", test::cut_scene()), out = scratch_.path("out");
  ASSERT_EQ(test::sulcus_command("run " + scene + " -o " + out, scratch_.path("stderr")).status, 0);
  const CommandResult result = view_and_stop(out + "/recording.h5", out + "/recording.h5", "INT");
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_EQ(result.err, "sulcus: stopped\n");
}

}  // namespace
}  // namespace sulcus::view_test
