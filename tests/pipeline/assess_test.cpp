// sulcus assess: of recordings and of meshes.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/import/meshes/mesh_file.hpp"
#include "tests/assessment/lofted_solid.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::assess_test {
namespace {

/// A block into which a flat fissure burr is sunk 1 mm deep at 2 mm/s, and 0.5 mm to a side.
const std::string kPocket = "tissue = ['enamel']" +
                            test::block_and_fissure_burr("[4, 4, 2]", "0.05", "[96, 96, 64]") +
                            R"([trajectory]
axis = [0, 0, 1]
points_mm = [
  [0, 0, 1.2], [0, 0, 0], [0.5, 0, 0], [0.5, 0, 0.2], [0.5, 0, 0], [0, 0, 0], [0, 0, 1.4]]
speed_mm_per_s = 2
[haptics]
normals = "ldm_fast"
[cutting]
[record]
)";

class Assess : public ::testing::Test {
 protected:
  test::CommandResult command(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"));
  }
  std::string run(const std::string& name, const std::string& scene,
                  const std::string& options = {}) {
    const auto result = command("run " + scratch_.write(name + ".toml", scene) + " " + options +
                                " -o " + scratch_.path(name));
    EXPECT_EQ(result.status, 0) << result.err;
    return scratch_.path(name) + "/recording.h5";
  }
  nlohmann::json assessment(const std::string& arguments,
                            const std::string& drawn = "--no-render") {
    const auto result =
        command("assess " + arguments + " " + drawn + " --force -o " + scratch_.path("assessed"));
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(test::read_file(scratch_.path("assessed/assessment.json")));
  }
  /// What assesses a recording's tooth as it was and as it is, exported into two files.
  std::string exported_pair(const std::string& recording, const std::string& option,
                            const std::string& before, const std::string& after) {
    const std::string first = scratch_.path(before), last = scratch_.path(after);
    EXPECT_EQ(command("export " + recording + " --at 0 " + option + " " + first).status, 0);
    EXPECT_EQ(command("export " + recording + " " + option + " " + last).status, 0);
    return "--before " + first + " --after " + last;
  }
  static nlohmann::json measure(const nlohmann::json& assessment, const std::string& name) {
    for (const auto& measure : assessment["measures"]) {
      if (measure["name"] == name) return measure;
    }
    ADD_FAILURE() << name << " was not measured";
    return {};
  }
  const ScratchFolder scratch_;
};

TEST_F(Assess, AScriptedPocketIsMeasuredAndWhatIsNotMetIsPlacedAndTimed) {
  const std::string recording =
      run("pocket", kPocket +
                        "[assessment]\ndepth_mm = [1.4, 1.6]\nundercut_mm2 = 0\n"
                        "isthmus_mm = [0.9, 1.1]\nmargin_mm = 1\nforce_N = 1e4\n"
                        "weights.depth_mm = 2\n");
  const nlohmann::json found = assessment(recording);
  const auto depth = measure(found, "depth_mm");
  EXPECT_NEAR(depth["value"], 1.0, 0.03);
  EXPECT_EQ(depth["unit"], "mm");
  EXPECT_EQ(depth["limit"], nlohmann::json::parse("[1.4, 1.6]"));
  EXPECT_EQ(depth["met"], false);
  EXPECT_NEAR(depth["position_mm"][2], 0.0, 0.05);
  EXPECT_GE(depth["time_s"], 0.55);  // the floor is reached 0.6 s after the start
  EXPECT_LE(depth["time_s"], 1.2);
  EXPECT_EQ(depth["time_s"].get<double>(), 1e-3 * depth["tick"].get<double>());
  EXPECT_NEAR(measure(found, "isthmus_mm")["value"], 1.0, 0.05);
  EXPECT_EQ(measure(found, "isthmus_mm")["met"], true);
  EXPECT_NEAR(measure(found, "convergence_deg")["value"], 0.0, 1.0);
  EXPECT_EQ(measure(found, "convergence_deg")["limit"], nullptr);
  EXPECT_EQ(measure(found, "undercut_mm2")["value"], 0.0);
  EXPECT_NEAR(measure(found, "wall_left_mm")["value"], 1.0, 0.06);
  EXPECT_EQ(found["not_measured"], nlohmann::json::parse("[\"margin_mm\"]"));
  EXPECT_DOUBLE_EQ(found["mark"], 60.0);  // of 2, 1, 1 and 1, all but the depth
}

TEST_F(Assess, TheMomentOfWhatIsNotMetIsDrawn) {
  const std::string recording =
      run("pocket", kPocket + "[assessment]\ndepth_mm = [1.4, 1.6]\nundercut_mm2 = 0\n");
  const nlohmann::json found = assessment(recording, "");
  const auto depth = measure(found, "depth_mm");
  EXPECT_EQ(depth["picture"], "depth_mm.png");
  EXPECT_EQ(depth["film"], "depth_mm.mp4");
  EXPECT_NEAR(depth["moment"]["burr_angle_deg"], 0.0, 1e-9);
  ASSERT_EQ(command("export " + recording + " --csv " + scratch_.path("ticks.csv")).status, 0);
  std::ifstream rows(scratch_.path("ticks.csv"));
  std::string row;
  for (int line = -1; line <= depth["tick"].get<int>(); ++line) std::getline(rows, row);
  std::istringstream cells(row);
  std::vector<double> values;
  for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
  EXPECT_EQ(values.at(0), depth["tick"].get<double>());
  EXPECT_NEAR(depth["moment"]["tip_mm"][2], values.at(4), 1e-6);
  EXPECT_NEAR(depth["moment"]["force_N"], std::hypot(values.at(9), values.at(10), values.at(11)),
              1e-6);
  EXPECT_FALSE(measure(found, "undercut_mm2").contains("picture"));  // it is met
  // Two seconds of 30 pictures, as ffmpeg itself counts them.
  const auto frames = test::program_command(
      "ffprobe",
      "-v error -count_frames -select_streams v -show_entries stream=nb_read_frames -of csv=p=0 " +
          scratch_.path("assessed/depth_mm.mp4"),
      scratch_.path("err"));
  EXPECT_EQ(frames.out.substr(0, 2), "60") << frames.err;
  EXPECT_GT(test::read_file(scratch_.path("assessed/depth_mm.png")).size(), 10'000u);
}

TEST_F(Assess, MeshesGiveWhatTheRecordingGives) {
  const std::string recording = run("pocket", kPocket);
  const std::string limits = scratch_.write("a.toml", "[assessment]\ndepth_mm = 2\n");
  const std::string pair = exported_pair(recording, "--mesh", "before.stl", "after.ply");
  const std::string before = scratch_.path("before.stl"), after = scratch_.path("after.ply");
  const nlohmann::json of_run = assessment(recording + " --assessment " + limits);
  const nlohmann::json of_meshes = assessment(pair + " --assessment " + limits);
  for (const char* name : {"depth_mm", "isthmus_mm", "convergence_deg", "undercut_mm2"}) {
    EXPECT_NEAR(measure(of_meshes, name)["value"].get<double>(),
                measure(of_run, name)["value"].get<double>(), 1e-3)
        << name;
  }
  EXPECT_EQ(measure(of_meshes, "depth_mm")["tick"], nullptr);
  EXPECT_DOUBLE_EQ(of_meshes["mark"], 100.0);

  // Inside out it is the same tooth; with a hole it is none.
  TriangleMesh turned = read_mesh(after);
  for (auto& triangle : turned.triangles) std::swap(triangle[1], triangle[2]);
  write_mesh(scratch_.path("turned.stl"), turned);
  const nlohmann::json of_turned = assessment(
      "--before " + before + " --after " + scratch_.path("turned.stl") + " --assessment " + limits);
  EXPECT_NEAR(measure(of_turned, "depth_mm")["value"].get<double>(),
              measure(of_meshes, "depth_mm")["value"].get<double>(), 1e-4);
  turned.triangles.pop_back();
  write_mesh(scratch_.path("open.stl"), turned);
  const auto open = command("assess --before " + before + " --after " + scratch_.path("open.stl") +
                            " --assessment " + limits);
  EXPECT_EQ(open.status, 2);
  EXPECT_NE(open.err.find("a surface with holes"), std::string::npos) << open.err;

  TriangleMesh moved = read_mesh(after);
  for (Eigen::Vector3f& p : moved.positions) p.x() += 0.4e-3f;
  write_mesh(scratch_.path("moved.stl"), moved);
  const auto refused = command("assess --before " + before + " --after " +
                               scratch_.path("moved.stl") + " --assessment " + limits);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("outside of --before"), std::string::npos) << refused.err;
}

constexpr std::array kAgainstAPlan{"over_mm",          "under_mm",         "goal_error_mm",
                                   "goal_error_95_mm", "within_tolerance", "dice"};

/// The block with a box in it: its upper face is at z = 1 mm.
TriangleMesh planned_block(double floor_mm) {
  const test::Rectangle bottom{-2, 2, -2, 2, -1}, floor{-0.5, 1, -0.5, 0.5, floor_mm};
  return test::lofted_mesh(
      {bottom, test::raised(bottom, 2, {}), test::raised(floor, 1 - floor_mm, {}), floor}, 3,
      Eigen::Affine3d::Identity());
}

TEST_F(Assess, APlanForMeshesGivesWhatAGoalGives) {
  // 0.3 mm less deep than the burr went, and with corners into which it does not reach.
  const std::string recording = run("pocket", kPocket +
                                                  "[goal]\nshape = 'box'\nsize_mm = [1.5, 1, 1]\n"
                                                  "position_mm = [0.25, 0, 0.8]\n");
  const std::string limits =
      scratch_.write("a.toml", "[assessment]\nover_mm = 0.2\ndice = 0.5\ntolerance_mm = 0.2\n");
  const std::string pair = exported_pair(recording, "--mesh", "before.stl", "after.ply");
  write_mesh(scratch_.path("plan.stl"), planned_block(0.3));
  const std::string plan = " --plan " + scratch_.path("plan.stl");
  const nlohmann::json of_run = assessment(recording + " --assessment " + limits);
  const nlohmann::json of_meshes = assessment(pair + plan + " --assessment " + limits);
  for (const char* name : kAgainstAPlan) {
    // Of voxels to the voxel.
    EXPECT_NEAR(measure(of_meshes, name)["value"].get<double>(),
                measure(of_run, name)["value"].get<double>(), 0.051)
        << name;
    EXPECT_EQ(measure(of_meshes, name)["unit"], measure(of_run, name)["unit"]);
    EXPECT_EQ(measure(of_meshes, name)["limit"], measure(of_run, name)["limit"]);
  }
  const auto over = measure(of_meshes, "over_mm");
  EXPECT_NEAR(over["value"], 0.3, 0.03);
  EXPECT_NEAR(over["position_mm"][2], 0.0, 0.03);
  EXPECT_EQ(over["met"], false);
  EXPECT_EQ(over["tick"], nullptr);
  EXPECT_NEAR(measure(of_meshes, "under_mm")["value"], (1.0 - std::sqrt(0.5)) / 2.0, 0.03);
  EXPECT_DOUBLE_EQ(of_meshes["mark"], 50.0);
}

TEST_F(Assess, APlanMayBeAVolume) {
  const std::string recording = run("pocket", kPocket);
  const std::string limits = scratch_.write("a.toml", "[assessment]\nover_mm = 0.01\n");
  const std::string pair = exported_pair(recording, "--mesh", "before.stl", "after.ply");
  exported_pair(recording, "--volume", "before.nrrd", "after.nrrd");
  const nlohmann::json found =
      assessment(pair + " --plan " + scratch_.path("after.nrrd") + " --assessment " + limits);
  EXPECT_NEAR(measure(found, "goal_error_95_mm")["value"], 0.0, 1e-3);
  EXPECT_NEAR(measure(found, "dice")["value"], 1.0, 1e-3);
  EXPECT_EQ(measure(found, "within_tolerance")["value"], 1.0);
  EXPECT_DOUBLE_EQ(found["mark"], 100.0);
}

TEST_F(Assess, APlanThatIsNotOfTheToothIsRefused) {
  const std::string recording = run("pocket", kPocket);
  const std::string limits = scratch_.write("a.toml", "[assessment]\nover_mm = 0.01\n");
  const std::string pair = exported_pair(recording, "--mesh", "before.stl", "after.ply");
  TriangleMesh moved = planned_block(0.3);
  for (Eigen::Vector3f& p : moved.positions) p.x() += 0.4e-3f;
  write_mesh(scratch_.path("moved.stl"), moved);
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const auto result = command("assess " + arguments + " --assessment " + limits);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  const std::string plan = " --plan " + scratch_.path("moved.stl");
  refused(pair + plan, "moved.stl: --plan: found 11 % of it outside of --before");
  refused(pair + " --plan " + scratch_.path("before.stl"),
          "--plan: found nothing removed that is deeper");
  refused(recording + plan, "expected both; what a recording was to become");
  refused(plan, "--plan: found no --before and --after");
  refused("--before " + scratch_.path("before.stl") + plan, "one of --before and --after");
}

TEST_F(Assess, WallsAreMeasuredBySide) {
  const std::string recording = run("pocket", kPocket);
  // A slot of straight walls along x; then the tooth as one of the other half of the mouth.
  const nlohmann::json found = assessment(
      recording + " --assessment " +
      scratch_.write("a.toml",
                     "[assessment]\nwall_mesial_deg = [-2, 2]\nwall_buccal_deg = [3, 8]\n"));
  for (const char* name :
       {"wall_mesial_deg", "wall_distal_deg", "wall_buccal_deg", "wall_lingual_deg"}) {
    EXPECT_NEAR(measure(found, name)["value"], 0.0, 2.0) << name;
    EXPECT_EQ(measure(found, name)["unit"], "deg");
    EXPECT_FALSE(measure(found, name)["time_s"].is_null());
  }
  EXPECT_GT(measure(found, "wall_mesial_deg")["position_mm"][0], 0.5);
  EXPECT_LT(measure(found, "wall_distal_deg")["position_mm"][0], 0.0);
  EXPECT_LT(measure(found, "wall_buccal_deg")["position_mm"][1], -0.2);  // the ends are round
  EXPECT_GT(measure(found, "wall_lingual_deg")["position_mm"][1], 0.2);
  EXPECT_DOUBLE_EQ(found["mark"], 50.0);
  const nlohmann::json mirrored =
      assessment(recording + " --assessment " +
                 scratch_.write("b.toml", "[assessment]\nbuccal = [0, 1, 0]\n"));
  EXPECT_GT(measure(mirrored, "wall_buccal_deg")["position_mm"][1], 0.2);
}

TEST_F(Assess, VolumesGiveWhatTheRecordingGives) {
  const std::string recording = run("pocket", kPocket);
  const std::string limits = scratch_.write("a.toml", "[assessment]\ndepth_mm = 2\n");
  const std::string pair = exported_pair(recording, "--volume", "before.nrrd", "after.nii.gz");
  const nlohmann::json of_run = assessment(recording + " --assessment " + limits);
  const nlohmann::json of_volumes = assessment(pair + " --assessment " + limits);
  // The rays stand elsewhere, by a part of a voxel.
  for (const auto& [name, most] :
       {std::pair{"depth_mm", 2e-3}, std::pair{"isthmus_mm", 2e-3},
        std::pair{"convergence_deg", 0.1}, std::pair{"undercut_mm2", 2e-3}}) {
    EXPECT_NEAR(measure(of_volumes, name)["value"].get<double>(),
                measure(of_run, name)["value"].get<double>(), most)
        << name;
  }
}

/// A block of 4 x 4 x 2 mm with a pocket of a flat floor, 1 mm wide and `depth_mm` deep, by how
/// much of each voxel it fills: grey values from -1000 to 1000, in voxels that are no cubes,
/// somewhere, turned about z.
std::string grey_block(const ScratchFolder& scratch, const std::string& name, double depth_mm,
                       double turned_deg) {
  constexpr double kAcross_mm = 0.05, kAlong_mm = 0.08;
  constexpr int kWide = 100, kTall = 40;
  const double turned = turned_deg * std::numbers::pi / 180.0;
  const double along = kAcross_mm * std::cos(turned), aside = kAcross_mm * std::sin(turned);
  std::ostringstream out;
  out.precision(17);
  out << "NRRD0004\ntype: float\ndimension: 3\nsizes: " << kWide << ' ' << kWide << ' ' << kTall
      << "\nspace: left-posterior-superior\nspace directions: (" << along << ',' << aside << ",0) ("
      << -aside << ',' << along << ",0) (0,0," << kAlong_mm
      << ")\nspace origin: (30,-40,120)\nendian: little\nencoding: raw\n\n";
  for (int k = 0; k < kTall; ++k) {
    for (int j = 0; j < kWide; ++j) {
      for (int i = 0; i < kWide; ++i) {
        const double x = (i - 0.5 * (kWide - 1)) * kAcross_mm;
        const double y = (j - 0.5 * (kWide - 1)) * kAcross_mm;
        const double z = (k - 0.5 * (kTall - 1)) * kAlong_mm;
        const double block = std::max({std::abs(x) - 2.0, std::abs(y) - 2.0, std::abs(z) - 1.0});
        const double pocket = std::max(std::hypot(x, y) - 0.5, 1.0 - depth_mm - z);
        const double outside = depth_mm > 0.0 ? std::max(block, -pocket) : block;
        const auto grey = static_cast<float>(1000.0 * std::clamp(-outside / kAlong_mm, -1.0, 1.0));
        out.write(reinterpret_cast<const char*>(&grey), sizeof grey);
      }
    }
  }
  return scratch.write(name, out.str());
}

TEST_F(Assess, GreyVolumesGiveWhatIsInThem) {
  std::string pair;
  for (const double turned_deg : {0.0, 33.0}) {
    SCOPED_TRACE(turned_deg);
    const std::string before = grey_block(scratch_, "before.nrrd", 0.0, turned_deg);
    const std::string after = grey_block(scratch_, "after.nrrd", 1.2, turned_deg);
    pair = "--before " + before + " --after " + after + " --assessment " +
           scratch_.write("a.toml", "[assessment]\ndepth_mm = 2\n");
    const nlohmann::json found = assessment(pair + " --solid-above 0");
    EXPECT_NEAR(measure(found, "depth_mm")["value"].get<double>(), 1.2, 0.025);
    EXPECT_NEAR(measure(found, "isthmus_mm")["value"].get<double>(), 1.0, 0.05);
    EXPECT_NEAR(measure(found, "convergence_deg")["value"].get<double>(), 0.0, 1.0);
    const std::vector<double> place = measure(found, "depth_mm")["position_mm"];
    EXPECT_NEAR(place.at(2), 120.0 + 19.5 * 0.08 + 1.0 - 1.2, 0.05) << "in the file's space";
  }
  const auto refused = command("assess " + pair);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("grey values, expected --solid-above"), std::string::npos)
      << refused.err;
}

TEST_F(Assess, AWholeRunCountsHoweverOftenItWasGoneOnFrom) {
  const std::string scene = kPocket + "[assessment]\npreset = 'class_one'\n";
  const std::string whole = run("whole", scene);
  ASSERT_EQ(command("replay " + whole + " --from 0.7 -o " + scratch_.path("on")).status, 0);
  const nlohmann::json of_whole = assessment(whole),
                       of_parts = assessment(scratch_.path("on/recording.h5"));
  for (const auto& expected : of_whole["measures"]) {
    const auto found = measure(of_parts, expected["name"]);
    EXPECT_DOUBLE_EQ(found["value"], expected["value"]) << expected["name"];
    EXPECT_EQ(found["met"], expected["met"]);
  }
  EXPECT_EQ(of_parts["mark"], of_whole["mark"]);
}

TEST_F(Assess, SeveralAttemptsGiveATable) {
  const std::string scene = kPocket + "[assessment]\ndepth_mm = [0.9, 1.1]\n";
  const std::string good = run("good", scene);
  const std::string deep =
      run("deep", scene,
          "--set 'trajectory.points_mm=[[0, 0, 1.2], [0, 0, -0.4], [0.5, 0, -0.4], [0, 0, 1.4]]'");
  const auto result =
      command("assess " + good + " " + deep + " --no-render -o " + scratch_.path("class"));
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string table = test::read_file(scratch_.path("class/assessment.csv"));
  EXPECT_TRUE(table.starts_with("attempt,subject,mark,depth_mm,")) << table;
  EXPECT_NE(table.find("\n1,\"" + good + "\",100,"), std::string::npos) << table;
  EXPECT_NE(table.find("\n2,\"" + deep + "\",0,"), std::string::npos) << table;
  EXPECT_FALSE(test::read_file(scratch_.path("class/2/assessment.json")).empty());
}

TEST_F(Assess, WhatCannotBeAssessedIsSaidInALine) {
  const std::string recording = run("none", kPocket, "--set 'trajectory.points_mm=[[0, 0, 3]]'");
  const std::string limits = scratch_.write("a.toml", "[assessment]\ndepth_mm = 2\n");
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const auto result = command("assess " + arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  refused("", "nothing to assess");
  refused(recording, "--assessment FILE.toml");
  refused(recording + " --assessment " + limits, "nothing removed that is deeper than 0.05 mm");
  refused(recording + " --assessment " + scratch_.path("absent.toml"), "no readable file");
  const std::string before = scratch_.path("before.stl"), scratched = scratch_.path("after.stl");
  write_mesh(before, test::lofted_mesh({{-2, 2, -2, 2, -1}, {-2, 2, -2, 2, 1}}, 3,
                                       Eigen::Affine3d::Identity()));
  write_mesh(scratched, planned_block(0.97));
  refused("--before " + before + " --after " + scratched + " --assessment " + limits,
          "nothing removed that is deeper than 0.05 mm");
  refused("--before a.stl --assessment " + limits, "one of --before and --after");
  refused("--before a.stl --after b.stl", "no --assessment");
}

}  // namespace
}  // namespace sulcus::assess_test
