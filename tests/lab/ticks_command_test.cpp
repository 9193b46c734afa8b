#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::ticks_command_test {
namespace {

TEST(TicksCommand, BadOptionsAreOneLineAndStatus2) {
  struct Bad {
    const char *arguments, *named;
  };
  for (const Bad& bad : {Bad{"--contacts 0", "--contacts"}, Bad{"--contacts many", "many"},
                         Bad{"--method ldm,laplace", "'laplace'"}, Bad{"--method pca", "'pca'"},
                         Bad{"--measure shapes", "shapes"}, Bad{"--quick --cells 7", "--cells"}}) {
    SCOPED_TRACE(bad.arguments);
    const ScratchFolder scratch;
    const auto result = test::program_command(
        SULCUS_LAB_PROGRAM, "ticks -o " + scratch.path("out") + " " + bad.arguments,
        scratch.path("err"));
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find(bad.named), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(scratch.path("out")));
  }
}

TEST(TicksCommand, MeasuresWhatIsAskedForAlone) {
  const ScratchFolder scratch;
  const std::string out = scratch.path("out");
  const auto result = test::program_command(
      SULCUS_LAB_PROGRAM, "ticks --quick --method ldm_fast --measure bodies -o " + out,
      scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find(out + "/ticks_bodies.csv"), std::string::npos) << result.out;
  std::set<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(out)) {
    files.insert(file.path().filename());
  }
  EXPECT_EQ(files, std::set<std::string>{"ticks_bodies.csv"});
}

/// Signals are its main's, whatever it measures.
TEST(TicksCommand, IsStoppedAtOnce) {
  const ScratchFolder scratch;
  for (const auto& [signal, status] : {std::pair{"INT", 130}, {"TERM", 143}}) {
    const auto result = test::program_command(
        std::string("timeout --preserve-status -s ") + signal + " 1 " SULCUS_LAB_PROGRAM,
        "ticks -o " + scratch.path("out"), scratch.path("err"));
    EXPECT_EQ(result.status, status);
    EXPECT_EQ(result.err, "sulcus: stopped\n");
  }
}

}  // namespace
}  // namespace sulcus::ticks_command_test
