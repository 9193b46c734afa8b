#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::lab_program_test {
namespace {

TEST(LabProgram, WhatIsSaidGoesIntoNoTableWhereStandardOutputIsClosed) {
  const ScratchFolder scratch;
  const auto result = test::program_command(
      "sh",
      "-c 'exec " SULCUS_LAB_PROGRAM " normals --shape tetrahedron --ns 1 --method ldm_fast -o " +
          scratch.path("out") + " >&-'",
      scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  std::ifstream table(scratch.path("out/normals.csv"));
  std::string header, line;
  std::getline(table, header);
  int rows = 0;
  for (; std::getline(table, line); ++rows) {
    EXPECT_EQ(std::ranges::count(line, ','), std::ranges::count(header, ',')) << line;
  }
  EXPECT_GT(rows, 0);
}

TEST(LabProgram, WhatCannotBeSaidIsAFailure) {
  const ScratchFolder scratch;
  const auto result =
      test::program_command(SULCUS_LAB_PROGRAM, "ticks --help > /dev/full", scratch.path("err"));
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err, "sulcus-lab: standard output: cannot be written\n");
}

TEST(LabProgram, WhatCannotBeMeasuredIsOneLineAndStatus2) {
  const ScratchFolder scratch;
  std::filesystem::create_directories(scratch.path("empty"));
  struct Bad {
    std::string arguments, named;
  };
  for (const auto& [arguments, named] :
       {Bad{"frames --seconds nan", "--seconds"}, Bad{"recordings --minutes nan", "--minutes"},
        Bad{"recordings --case reach --scene nowhere", "nowhere"},
        Bad{"program --trial start --against " + scratch.path("empty"), "found no sulcus"}}) {
    const auto result = test::program_command(
        SULCUS_LAB_PROGRAM, arguments + " -o " + scratch.path("out"), scratch.path("err"));
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(result.err_lines(), 1) << arguments << ": " << result.err;
    EXPECT_NE(result.err.find(named), std::string::npos) << arguments << ": " << result.err;
    EXPECT_FALSE(std::filesystem::exists(scratch.path("out"))) << arguments;
  }
}

}  // namespace
}  // namespace sulcus::lab_program_test
