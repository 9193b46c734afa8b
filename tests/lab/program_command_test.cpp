#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::program_command_test {
namespace {

namespace fs = std::filesystem;

std::string build_folder() { return fs::path(SULCUS_LAB_PROGRAM).parent_path().string(); }

TEST(ProgramCommand, MeasuresTwoBuildsInTurn) {
  const ScratchFolder scratch;
  const std::string out = scratch.path("out");
  scratch.write("out/here/kept", "of a user's");
  const auto result = test::program_command(
      SULCUS_LAB_PROGRAM,
      "program --trial start,verify --repeats 1 -o " + out + " --against " + build_folder(),
      scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;

  std::ifstream table(out + "/program.csv");
  std::string line, cell;
  std::getline(table, line);
  EXPECT_EQ(line, "trial,figure,median,lowest,highest,against,ratio");
  std::map<std::string, std::vector<double>> rows;
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::string trial, figure;
    std::getline(cells, trial, ',');
    std::getline(cells, figure, ',');
    std::vector<double>& values = rows[trial + ' ' + figure];
    while (std::getline(cells, cell, ',')) values.push_back(std::stod(cell));
    ASSERT_EQ(values.size(), 5u) << line;
    for (const double value : values) EXPECT_GT(value, 0.0) << line;
    EXPECT_NEAR(values[4], values[0] / values[3], 1e-3 * values[4]) << line;
  }
  ASSERT_EQ(rows.size(), 12u);
  // What both trials say of the same work: opening a recording takes less than all of it.
  EXPECT_LT(rows["start cached_cpu_s"][0], rows["start cold_cpu_s"][0]);
  EXPECT_TRUE(fs::exists(out + "/here/kept"));
  EXPECT_EQ(std::distance(fs::directory_iterator(out), {}), 2) << "what the trials wrote is left";
}

TEST(ProgramCommand, BadOptionsAreOneLineAndStatus2) {
  for (const std::string bad : {"--trial speed", "--against /nowhere", "--repeats 0"}) {
    SCOPED_TRACE(bad);
    const ScratchFolder scratch;
    const auto result = test::program_command(
        SULCUS_LAB_PROGRAM, "program -o " + scratch.path("out") + " " + bad, scratch.path("err"));
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_FALSE(fs::exists(scratch.path("out")));
  }
}

}  // namespace
}  // namespace sulcus::program_command_test
