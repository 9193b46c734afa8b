#include <algorithm>
#include <array>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/documented_commands.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::documented_lab_commands_test {
namespace {

namespace fs = std::filesystem;

/// What makes a measurement of minutes one of seconds, and a file that it ends with.
struct Shortened {
  std::string_view subcommand, by, writes;
};
constexpr std::array kShortened{
    Shortened{"fractions", "--quick --measure planes", "fractions.png"},
    Shortened{"laws", "--quick --law at_rest", "laws.html"},
    Shortened{"normals", "--ns 3", "normals.png"},
    Shortened{"program", "--trial verify --repeats 1", "program.csv"},
    Shortened{"ticks", "--quick", "ticks.csv"},
    Shortened{"reality", "--quick", "reality.csv"},
    Shortened{"stability", "--brief --case thin_wall", "stability.html"},
};

TEST(DocumentedLab, CommandsOfTheReadmesRun) {
  const fs::path root = SULCUS_SOURCE_DIR;
  const std::string tool = "tools/lab ";
  const ScratchFolder scratch;
  std::set<std::string> ran;  // those that several name once
  for (const fs::path& readme : test::readmes(root)) {
    for (const test::DocumentedStep& step : test::documented_steps(readme, {tool})) {
      SCOPED_TRACE(fs::relative(readme, root).string() + ":" + std::to_string(step.line) + ": " +
                   step.text);
      std::string command = step.text.substr(tool.size());
      if (!ran.insert(command).second) continue;
      const auto shortened = std::ranges::find_if(
          kShortened, [&](const Shortened& s) { return command.starts_with(s.subcommand); });
      ASSERT_NE(shortened, kShortened.end()) << "no way is known to make it short";
      // Of thousands of contacts there are none in reach of a burr in coarse voxels.
      command = std::regex_replace(command, std::regex(",[0-9]{4,}"), "");
      const std::string folder = scratch.path(std::to_string(ran.size()));
      const auto result = test::program_command(
          SULCUS_LAB_PROGRAM, command + " " + std::string(shortened->by) + " -o " + folder,
          scratch.path("err"));
      EXPECT_EQ(result.status, 0) << result.out << result.err;
      EXPECT_TRUE(fs::exists(fs::path(folder) / shortened->writes));
    }
  }
  EXPECT_GE(ran.size(), 5u);
}

}  // namespace
}  // namespace sulcus::documented_lab_commands_test
