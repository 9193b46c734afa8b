#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/recording/recording_layout.hpp"
#include "engine/scene/scene_keys.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::help_test {
namespace {

using test::read_file, test::sulcus_command;

/// What `sulcus ARGUMENTS` prints; it must end with status 0.
std::string printed(const ScratchFolder& scratch, const std::string& arguments) {
  const auto result = sulcus_command(arguments, scratch.path("err"));
  EXPECT_EQ(result.status, 0) << arguments << ": " << result.err;
  return result.out;
}

/// Every match of the first group of `pattern`, a line's beginning being "^".
std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern, std::regex::multiline);
  std::vector<std::string> found;
  for (auto i = std::sregex_iterator(text.begin(), text.end(), regex); i != std::sregex_iterator();
       ++i) {
    found.push_back((*i)[1]);
  }
  return found;
}

std::vector<std::string> commands(const ScratchFolder& scratch) {
  const std::string help = printed(scratch, "--help");
  const std::size_t begin = help.find("Subcommands:");
  return matches(help.substr(begin, help.find("\n\n", begin) - begin), "^  ([a-z]+) ");
}

TEST(Help, SceneTellsEveryKeyOfTheReader) {
  const ScratchFolder scratch;
  const std::string help = printed(scratch, "help scene");
  std::size_t at = 0, count = 0;
  for (const SceneTableKeys& table : scene_tables()) {
    if (!table.name.empty())
      at = help.find("\n[" + std::string(table.repeated ? "[" : "") + std::string(table.name) + "]",
                     at);
    ASSERT_NE(at, std::string::npos) << table.name;
    for (const SceneKey& key : table.keys) {
      at = help.find("\n  " + std::string(key.key), at);
      ASSERT_NE(at, std::string::npos) << table.name << "." << key.key;
      ++count;
    }
  }
  const std::string plain = std::regex_replace(help, std::regex("\\s+"), " ");
  EXPECT_NE(plain.find("voxel_mm number, mm, 0.001 to 10; default 0.0348 edge of a voxel"),
            std::string::npos);
  // And nothing else.
  EXPECT_EQ(matches(help, "^  ([a-zA-Z0-9_]+)(?: |$)").size(), count);
}

TEST(Help, RecordingTellsAllOfTheLayout) {
  const ScratchFolder scratch;
  const std::string help = printed(scratch, "help recording");
  printed(scratch, "help --write " + scratch.path("share"));
  const std::string page = read_file(scratch.path("share/man/man5/sulcus-recording.5"));
  std::size_t at = 0, on_page = 0;
  for (const StoredPart& part : recording_layout()) {
    at = help.find("\n" + std::string(part.path) + "  ", at);
    on_page = page.find("\n.SH " + std::string(part.path) + "\n", on_page);
    ASSERT_NE(at, std::string::npos) << part.path;
    ASSERT_NE(on_page, std::string::npos) << part.path;
    for (const StoredField& field : part.fields) {
      if (field.name.empty()) continue;
      at = help.find("\n  " + std::string(field.name) + " ", at);
      on_page = page.find(".B " + std::string(field.name) + "\n", on_page);
      ASSERT_NE(at, std::string::npos) << part.path << " " << field.name;
      ASSERT_NE(on_page, std::string::npos) << part.path << " " << field.name;
    }
  }
  EXPECT_NE(help.find("  contact_force_N       f64[3], N: of the contact alone\n"),
            std::string::npos);
}

// The lines of Python are those that a reader may copy.
TEST(Help, RecordingsExampleRunsInPython) {
  const ScratchFolder scratch;
  if (std::system("/usr/bin/python3 -c 'import h5py' 2>/dev/null") != 0) {
    GTEST_SKIP() << "h5py is not installed";
  }
  const std::string scene = scratch.write("s.toml", test::cut_scene());
  ASSERT_EQ(sulcus_command("run " + scene + " --duration 0.2 -o " + scratch.path("out"),
                           scratch.path("err"))
                .status,
            0);
  const std::string help = printed(scratch, "help recording");
  const std::size_t begin = help.find("  import h5py"), end = help.find("\n\n", begin);
  ASSERT_NE(end, std::string::npos);
  const std::string lines =
      std::regex_replace(help.substr(begin, end - begin), std::regex("(^|\n)  "), "$1");
  scratch.write("out/read.py", lines + "\nprint(force_N.shape, 'shape = ' in scene, len(edits))\n");
  const auto result = test::program_command(
      "sh", "-c 'cd " + scratch.path("out") + " && /usr/bin/python3 read.py'", scratch.path("err"));
  EXPECT_EQ(result.out.substr(0, 14), "(200, 3) True ") << result.out << result.err;
}

TEST(Help, OfACommandIsItsOwn) {
  const ScratchFolder scratch;
  for (const std::string& command : commands(scratch)) {
    EXPECT_EQ(printed(scratch, "help " + command), printed(scratch, command + " --help"));
  }
  EXPECT_EQ(printed(scratch, "help"), printed(scratch, "--help"));
  const auto result = sulcus_command("help nonsense", scratch.path("err"));
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_NE(result.err.find("scene"), std::string::npos) << result.err;
}

TEST(Help, EveryOptionIsDescribedInHelpManualAndCompletion) {
  const ScratchFolder scratch;
  printed(scratch, "help --write " + scratch.path("share"));
  const std::string completion =
      read_file(scratch.path("share/bash-completion/completions/sulcus"));
  const std::vector<std::string> all = commands(scratch);
  EXPECT_GE(all.size(), 8u);
  for (const std::string& command : all) {
    const std::string help = printed(scratch, command + " --help");
    const std::string page = read_file(scratch.path("share/man/man1/sulcus-" + command + ".1"));
    const std::string words =
        matches(completion, "^ +" + command + "\\) _sulcus_words \"(.*)\"").at(0);
    for (const std::string& option : matches(help, "^  (?:-h,)?(--?[a-z-]+)")) {
      std::string escaped = std::regex_replace(option, std::regex("-"), "\\-");
      EXPECT_NE(page.find(escaped), std::string::npos) << command << " " << option;
      EXPECT_NE((" " + words).find(" " + option + " "), std::string::npos) << command << option;
    }
    // A tag in bold, then a line of text that says what it is.
    EXPECT_TRUE(matches(page, "^\\.B (.*)\\n(?:\\.|$)").empty()) << page;
  }
  EXPECT_TRUE(std::filesystem::exists(scratch.path("share/man/man1/sulcus.1")));
  EXPECT_NE(read_file(scratch.path("share/man/man5/sulcus-scene.5")).find("specific_energy_J_per"),
            std::string::npos);
  const auto refused = sulcus_command("help --write /proc/nowhere", scratch.path("err"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.err_lines(), 1) << refused.err;
}

/// What bash offers for the last of the words.
std::string completed(const ScratchFolder& scratch, const std::string& words) {
  const std::string script = scratch.write(
      "try.sh",
      "source '" + scratch.path("share/bash-completion/completions/sulcus") +
          "'\ncompopt() { :; }\nCOMP_WORDS=(" + words +
          ")\nCOMP_CWORD=$(( ${#COMP_WORDS[@]} - 1 ))\n_sulcus\necho \"${COMPREPLY[*]}\"\n");
  return test::program_command("bash", script, scratch.path("err")).out;
}

TEST(Help, CompletesInBash) {
  const ScratchFolder scratch;
  printed(scratch, "help --write " + scratch.path("share"));
  EXPECT_EQ(completed(scratch, "sulcus re"), "replay render repair\n");
  EXPECT_EQ(completed(scratch, "sulcus run --p"), "--pace --plugins\n");
  EXPECT_EQ(completed(scratch, "sulcus run --pace r"), "real\n");
  EXPECT_EQ(completed(scratch, "sulcus run --set spindle."),
            "spindle.preset= spindle.stall_torque_mNm= spindle.inertia_g_mm2= spindle.droop= "
            "spindle.power_W=\n");
  EXPECT_EQ(completed(scratch, "sulcus run --duration 1"), "\n");
  EXPECT_EQ(completed(scratch, "sulcus help sc"), "scene scenes\n");
  const std::string scene = scratch.write("a scene.toml", "");
  EXPECT_EQ(completed(scratch, "sulcus run '" + scratch.path("a s") + "'"), scene + "\n");
  EXPECT_EQ(completed(scratch, "sulcus run --no-render '" + scratch.path("a s") + "'"),
            scene + "\n");
}

}  // namespace
}  // namespace sulcus::help_test
