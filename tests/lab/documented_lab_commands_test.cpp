#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/documented_commands.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus {
namespace {

// They measure for minutes: each is begun, none is refused.
TEST(DocumentedLab, CommandsOfTheReadmeBegin) {
  const std::filesystem::path readme = std::filesystem::path(SULCUS_SOURCE_DIR) / "README.md";
  const std::string tool = "tools/lab";
  const ScratchFolder scratch;
  int begun = 0;
  for (const test::DocumentedStep& step : test::documented_steps(readme, {tool})) {
    SCOPED_TRACE("README.md:" + std::to_string(step.line) + ": " + step.text);
    const auto result = test::program_command("timeout 2",
                                              SULCUS_LAB_PROGRAM + step.text.substr(tool.size()) +
                                                  " -o " + scratch.path(std::to_string(begun)),
                                              scratch.path("err"));
    EXPECT_TRUE(result.status == 124 || result.status == 0) << result.status << "\n" << result.err;
    ++begun;
  }
  EXPECT_GE(begun, 4);
}

}  // namespace
}  // namespace sulcus
