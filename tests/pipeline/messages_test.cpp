// What a command says where something else was meant: names, files of another kind, runs that touch
// nothing; and tables that go out of a run and into the next.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/png_file.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::messages_test {
namespace {

class Messages : public testing::Test {
 protected:
  test::CommandResult command(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"),
                                "-C " + scratch_.path("") + " SULCUS_CACHE=off");
  }
  void expect_refused(const std::string& arguments, const std::string& says) {
    const auto result = command(arguments);
    EXPECT_EQ(result.status, 2) << arguments << ": " << result.err;
    EXPECT_EQ(result.err_lines(), 1) << arguments << ": " << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << arguments << ": " << result.err;
  }
  void run(const std::string& scene, const std::string& folder) {
    scratch_.write("s.toml", scene);
    const auto result = command("run s.toml -o " + folder);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  nlohmann::json summary(const std::string& folder) const {
    return nlohmann::json::parse(test::read_file(scratch_.path(folder + "/summary.json")));
  }
  ScratchFolder scratch_;
};

double number(const std::string& text, const std::string& pattern) {
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? std::stod(match[1]) : std::nan("");
}

TEST_F(Messages, ShippedScenesAreListed) {
  const auto help = command("help scenes");
  EXPECT_EQ(help.status, 0) << help.err;
  std::size_t scenes = 0;
  const std::filesystem::path folder(SULCUS_SOURCE_DIR "/scenes");
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".toml") continue;
    ++scenes;
    EXPECT_NE(help.out.find("\n  " + entry.path().stem().string() + " "), std::string::npos);
  }
  EXPECT_GT(scenes, 15u);
  EXPECT_NE(help.out.find("cut_loose            A cusp that falls\n"), std::string::npos);
  expect_refused("run nosuch", "or the name of a shipped one: access_cavity class_one_cavity ");
  EXPECT_NE(command("help scene").out.find("0.70710678, 0.70710678, 0, 0"), std::string::npos);
}

TEST_F(Messages, AFileOfAnotherKindIsRecognised) {
  run(test::cut_scene(), "out");
  expect_refused("run out/recording.h5",
                 "found a recording, expected a scene, .toml; sulcus replay");
  scratch_.write("tooth.stl", "x");
  scratch_.write("scan.nrrd", "x");
  for (const std::string file : {"tooth.stl", "scan.nrrd"}) {
    expect_refused("run " + file, "sulcus inspect says with which command it is cut");
  }
  // The folder of a run stands for its recording.
  EXPECT_EQ(command("render out --size 64x48 --sheet x.png").status, 0);
  EXPECT_EQ(command("replay --verify out").status, 0);
  EXPECT_EQ(command("inspect out").out, command("inspect out/recording.h5").out);
  std::filesystem::create_directory(scratch_.path("empty"));
  expect_refused("render empty", "empty: found");
}

TEST_F(Messages, AStartInsideSaysFromWhereOnItIsFree) {
  scratch_.write("s.toml", test::block_and_burr() + "[trajectory]\npoints_mm = [[0.2, 0, 0]]\n");
  const auto result = command("run s.toml -o out");
  EXPECT_EQ(result.status, 2);
  // The head's middle is about its radius, 0.4 mm, above the tip; the block's top face at 1 mm.
  EXPECT_NEAR(number(result.err, "at \\(0.200, 0.000, ([0-9.]+)\\) mm"), 0.4, 0.05) << result.err;
  EXPECT_NEAR(number(result.err, "free from z = ([0-9.]+) mm"), 1.0, 0.051) << result.err;
}

TEST_F(Messages, ARunThatTouchesNothingSaysHowNearItCame) {
  // Its tip comes to 0.3 mm above the top face, which lies at 1 mm.
  scratch_.write("s.toml", test::block_and_burr() + R"(
[trajectory]
points_mm = [[-0.6, 0, 2], [0, 0, 1.3], [0.6, 0, 2]]
speed_mm_per_s = 4
)");
  const auto result = command("run s.toml -o out");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_NEAR(number(result.err, "no nearer than about ([0-9.]+) mm"), 0.3, 0.06) << result.err;
  EXPECT_NEAR(number(result.err, "at ([0-9.]+) s with its tip"), std::hypot(0.6, 0.7) / 4, 0.01);
  scratch_.write("t.toml", test::probe_scene());
  EXPECT_EQ(command("run t.toml -o touched").err, "");
}

TEST_F(Messages, AFaultThatASceneAsksForIsSaidToBeWanted) {
  scratch_.write("s.toml", "title = \"a hand\"" + test::block_and_burr() + R"(
[trajectory]
points_mm = [[0, 0, 1.2], [0, 0, 0.9]]
speed_mm_per_s = 4
hold_s = 0.2
[device]
model = "simulated"
silent_s = [[0.1, 0.15]]
)");
  const auto result = command("run s.toml -o out");
  EXPECT_NE(result.err.find("a hand: fault device_silent in 31 ticks, as device.silent_s asks"),
            std::string::npos)
      << result.err;
}

/// A table's rows, by its columns' names.
std::vector<std::map<std::string, double>> rows_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line, cell;
  std::vector<std::string> names;
  std::getline(lines, line);
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
  std::vector<std::map<std::string, double>> rows;
  while (std::getline(lines, line)) {
    auto& row = rows.emplace_back();
    std::istringstream cells(line);
    for (const std::string& name : names) {
      std::getline(cells, cell, ',');
      row[name] = std::stod(cell);
    }
  }
  return rows;
}

TEST_F(Messages, AnExportedTableIsATrajectory) {
  run(test::probe_scene() + "[record]\n", "out");
  ASSERT_EQ(command("export out --csv ticks.csv").status, 0);
  const auto first = rows_of(test::read_file(scratch_.path("ticks.csv")));
  std::string again = test::probe_scene() + "[record]\n";
  again.replace(again.find("points_mm"), std::string::npos, "file = 'ticks.csv'\n[record]\n");
  run(again, "again");
  ASSERT_EQ(command("export again --csv again.csv").status, 0);
  const auto second = rows_of(test::read_file(scratch_.path("again.csv")));
  ASSERT_EQ(first.size(), second.size());
  double most_N = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_NEAR(first[i].at("device_x_mm"), second[i].at("device_x_mm"), 1e-6);
    EXPECT_NEAR(first[i].at("force_z_N"), second[i].at("force_z_N"), 1e-3);
    // Without a coupling all forces are that of the contact, and the tool is where the device is.
    EXPECT_EQ(first[i].at("contact_force_z_N"), first[i].at("force_z_N"));
    EXPECT_EQ(first[i].at("device_z_mm"), first[i].at("tool_z_mm"));
    most_N = std::max(most_N, first[i].at("force_z_N"));
  }
  EXPECT_GT(most_N, 0.5);
}

TEST_F(Messages, TheTableOfACoupledRunHasWhatWasAskedFor) {
  scratch_.write("s.toml", test::block_and_burr() + R"(
[trajectory]
points_mm = [[0, 0, 1.1], [0, 0, 0.6]]
speed_mm_per_s = 4
hold_s = 0.2
[device]
model = "simulated"
hand = "firm"
push_N = 1
force_limit_N = 0.2
[coupling]
force_limit_N = 3
[record]
)");
  ASSERT_EQ(command("run s.toml -o out").status, 0);
  ASSERT_EQ(command("export out --csv ticks.csv").status, 0);
  bool limited = false, stretched = false;
  for (const auto& row : rows_of(test::read_file(scratch_.path("ticks.csv")))) {
    EXPECT_LE(row.at("force_z_N"), 0.2 + 1e-6) << "the device's limit";
    limited |= row.at("asked_force_z_N") > 0.25;
    stretched |= row.at("tool_z_mm") > row.at("device_z_mm") + 0.05;
  }
  EXPECT_TRUE(limited);
  EXPECT_TRUE(stretched);
}

TEST_F(Messages, ATableThatBeginsLateIsSaid) {
  scratch_.write("poses.csv",
                 "\xef\xbb\xbf# by hand\nt_s, x_mm, y_mm, z_mm, qw, qx, qy, qz, note\n"
                 "0.5, 0, 0, 1.1, 0.70710678, 0.70710678, 0, 0, down\n"
                 "# and on\n0.7, 0, 0, 0.9, 0.70710678, 0.70710678, 0, 0, there\n");
  scratch_.write("s.toml", test::block_and_burr() + "[trajectory]\nfile = 'poses.csv'\n");
  const auto result = command("run s.toml -o out");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("its first pose is at 0.5 s, which is 0 s of the run"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(summary("out")["ticks"], 201);
  EXPECT_GT(summary("out")["force_N"]["max"], 0.0);
}

TEST_F(Messages, ASummarysNumbersAddUp) {
  run(test::cut_scene(), "out");
  const auto j = summary("out");
  double stages_us = 0.0;
  for (const auto& stage : j["stage_us"]) stages_us += stage["mean"].get<double>();
  EXPECT_LE(stages_us, j["tick_us"]["mean"].get<double>() * 1.001);
  EXPECT_NEAR(j["force_N"]["mean_in_contact"], j["outcome"]["mean_force_N"], 1e-6);
  EXPECT_GT(j["force_N"]["mean_in_contact"], j["force_N"]["mean"]);
  // What there was less what went is what is left.
  EXPECT_EQ(j["workpiece_start"]["solid_voxels"].get<int>() - j["removed_voxels"].get<int>(),
            j["workpiece"]["solid_voxels"].get<int>());
}

TEST_F(Messages, TheChartHasACurveForEachComponent) {
  run(test::cut_scene(), "out");
  const Image image = test::read_png(scratch_.path("out/forces.png"));
  for (const std::array<int, 3> colour :
       {std::array{0xc0, 0x39, 0x2b}, {0x2e, 0x8b, 0x57}, {0x1f, 0x4e, 0x9c}}) {
    int count = 0;
    for (std::size_t at = 0; at + 2 < image.rgb.size(); at += 3) {
      bool like = true;  // thin lines are smoothed
      for (std::size_t c = 0; c < 3; ++c) like &= std::abs(image.rgb[at + c] - colour[c]) <= 40;
      count += like ? 1 : 0;
    }
    EXPECT_GT(count, 150) << "force and torque, and two keys";
  }
}

}  // namespace
}  // namespace sulcus::messages_test
