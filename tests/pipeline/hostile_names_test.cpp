// Titles, file names and folders that are commands in the languages of the programs that Sulcus
// starts: every command is given them, and none may be run.

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::hostile_names_test {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;

/// As a POSIX shell takes it.
std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? "'\\''" : std::string(1, c);
  return safe + "'";
}

std::string with_unicode_escapes(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    char escaped[8];
    std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned char>(c));
    safe += escaped;
  }
  return safe;
}

class HostileNames : public testing::TestWithParam<const char*> {
 protected:
  /// In the scratch folder, where what a name runs would leave "found".
  CommandResult sulcus(const std::vector<std::string>& arguments) {
    std::string line;
    for (const std::string& argument : arguments) line += quoted(argument) + " ";
    const CommandResult result = test::sulcus_command(
        line, scratch_.path("stderr"), "-C " + quoted(scratch_.path("")) + " SULCUS_CACHE=off");
    EXPECT_FALSE(fs::exists(scratch_.path("found"))) << arguments[0] << " ran it";
    for (const std::string* said : {&result.out, &result.err}) {
      EXPECT_EQ(said->find('\x1b'), std::string::npos) << *said;
    }
    return result;
  }
  const std::string name_ = std::string("./") + GetParam();  // of a dash it is a path
  ScratchFolder scratch_;
};

TEST_P(HostileNames, NoCommandRunsThem) {
  std::string scene = test::cut_scene();
  const std::string title = "title = \"small\"";
  scene.replace(scene.find(title), title.size(),
                "title = \"" + with_unicode_escapes(GetParam()) + "\"");
  scratch_.write(name_ + ".toml", scene);
  const CommandResult run = sulcus({"run", name_ + ".toml", "--duration", "0.02", "-o", name_});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(fs::exists(scratch_.path(name_ + "/forces.png")));
  const std::string recording = name_ + "/recording.h5";
  EXPECT_EQ(sulcus({"replay", recording, "-o", name_ + " again"}).status, 0);
  EXPECT_EQ(sulcus({"replay", recording, "--verify"}).status, 0);
  EXPECT_EQ(sulcus({"inspect", recording}).status, 0);
  EXPECT_EQ(sulcus({"inspect", name_ + ".toml"}).status, 0);
  EXPECT_EQ(sulcus({"repair", recording, "-o", name_ + ".h5"}).status, 0);
  EXPECT_EQ(sulcus({"render", recording, "-o", name_}).status, 0);
  EXPECT_EQ(
      sulcus({"render", recording, "--fps", "100", "--size", "64x48", "--video", name_ + ".mp4"})
          .status,
      0);
  EXPECT_TRUE(fs::exists(scratch_.path(name_ + ".mp4")));
  EXPECT_EQ(sulcus({"render", recording, "--sheet", name_ + ".png"}).status, 0);
  EXPECT_EQ(sulcus({"render", recording, "--review", name_ + ".html"}).status, 0);
  const std::string page = test::read_file(scratch_.path(name_ + ".html"));
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_EQ(sulcus({"export", recording, "--mesh", name_ + ".stl", "--volume", name_ + ".nrrd",
                    "--csv", name_ + ".csv"})
                .status,
            0);
  const CommandResult inspected =
      sulcus({"inspect", name_ + ".nrrd", "--picture", name_ + "_volume.png"});
  EXPECT_EQ(inspected.status, 0) << inspected.err;
  EXPECT_TRUE(fs::exists(scratch_.path(name_ + "_volume.png")));
  EXPECT_EQ(sulcus({"inspect", name_ + ".stl"}).status, 0);
  sulcus({"inspect", name_ + ".stl", "--as-burr", "--picture", name_ + "_burr.png"});
  // A folder without a recording is refused, and told so in a line.
  const std::string empty = name_ + " empty";
  fs::create_directory(scratch_.path(empty));
  for (const char* command : {"run", "replay", "render", "inspect", "export", "repair"}) {
    const CommandResult refused = sulcus({command, empty});
    EXPECT_EQ(refused.status, 2) << command;
    EXPECT_EQ(refused.err_lines(), 1) << refused.err;
  }
  EXPECT_EQ(sulcus({name_}).status, 2);
  EXPECT_EQ(sulcus({"run", name_ + ".toml", "--set", "title." + name_ + "=1"}).status, 2);
  // The command that is proposed for the volume is of one word for each argument.
  if (const auto at = inspected.out.find("to cut it"); at != std::string::npos) {
    const std::string proposed =
        inspected.out.substr(at + 9, inspected.out.find('\n', at) - at - 9);
    scratch_.write("proposed", "set -- " + proposed + "\nprintf %s \"$5\"\n");
    const CommandResult word = test::program_command("bash", "proposed", scratch_.path("stderr"),
                                                     "-C " + quoted(scratch_.path("")));
    EXPECT_NE(word.out.find("workpiece.file="), std::string::npos) << word.out;
    EXPECT_FALSE(fs::exists(scratch_.path("found")));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, HostileNames,
    // Of each one, what it would have begun with; a name has 255 bytes and no '/'.
    testing::Values(
        "`touch found`$(touch found);touch found|touch found\nset print 'found'\nprint 1\n",
        "' . system(\"touch found\") . '\x1b]0;x\x07<b>\\",
        "\"`touch found`\" 10:03 %d %s {= system(q(touch found)) =}"),
    [](const auto& tested) { return "name_" + std::to_string(tested.index); });

}  // namespace
}  // namespace sulcus::hostile_names_test
