// Ten attempts at one slot, each with one fault that its script put somewhere at some time, and one
// without: what is not met is named, placed and timed.
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::assess_faults_test {
namespace {

constexpr double kBurrRadius_mm = 0.5;

/// The burr's tip at a time, its shank leaning towards +x.
struct Waypoint {
  double t_s, x_mm, y_mm, z_mm;
  double lean_deg = 0.0;
};
using Script = std::vector<Waypoint>;

// A slot of 2.5 x 1 mm, 1.5 mm deep, in the middle of a block; a neighbour stands 0.5 mm beside it.
const std::string kScene = "tissue = ['enamel']" +
                           test::block_and_fissure_burr("[5, 5, 3]", "0.05", "[128, 128, 72]") +
                           R"([[body]]
name = "neighbour"
shape = "box"
voxel_mm = 0.05
cells = [24, 64, 104]
box.size_mm = [1, 3, 5]
position_mm = [3.5, 0, 0]
cuttable = true
[trajectory]
file = "hand.csv"
[haptics]
normals = "ldm_fast"
[cutting]
[goal]
shape = "box"
size_mm = [2.5, 1, 2]
position_mm = [0, 0, 1]
[record]
[assessment]
depth_mm = [1.4, 1.6]
greatest_depth_mm = 1.65
convergence_deg = [-2, 2]
undercut_mm2 = 0
isthmus_mm = [0.9, 1.1]
greatest_roughness_um = 17
wall_left_mm = 1
neighbour_removed_mm3 = 0
over_mm = 0.25
under_mm = 0.3
force_N = 4
greatest_burr_angle_deg = 3
)";

/// The slot, up to the time of 3 s.
const Script kSlot{{0, -0.75, 0, 2}, {1, -0.75, 0, 0}, {2, 0.75, 0, 0}, {3, -0.75, 0, 0}};
const Script kAway{{0.5, -0.75, 0, 2.2}};

/// One after the other; the times of the second are from its own start.
Script in_turn(Script first, const Script& then) {
  const double end_s = first.back().t_s;
  for (Waypoint point : then) {
    point.t_s += end_s;
    first.push_back(point);
  }
  return first;
}

/// What is said of an attempt's limits that are not met.
struct Found {
  std::set<std::string> names;
  nlohmann::json measures;

  nlohmann::json at(const std::string& name) const {
    for (const auto& measure : measures) {
      if (measure["name"] == name) return measure;
    }
    return {};
  }
};

class AssessedFaults : public ::testing::Test {
 protected:
  Found attempt(const Script& script) {
    std::ofstream poses(scratch_.path("hand.csv"));
    poses << "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
    for (const Waypoint& p : script) {
      const Eigen::Quaterniond turn =
          Eigen::AngleAxisd(p.lean_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX());
      poses << p.t_s << ',' << p.x_mm << ',' << p.y_mm << ',' << p.z_mm << ',' << turn.w() << ','
            << turn.x() << ',' << turn.y() << ',' << turn.z() << '\n';
    }
    poses.close();
    command("run " + scratch_.write("slot.toml", kScene) + " --no-render -o " +
            scratch_.path("run"));
    command("assess " + scratch_.path("run/recording.h5") + " --no-render -o " +
            scratch_.path("run"));
    Found found;
    found.measures =
        nlohmann::json::parse(test::read_file(scratch_.path("run/assessment.json")))["measures"];
    for (const auto& measure : found.measures) {
      if (measure["met"] == false) found.names.insert(measure["name"]);
    }
    return found;
  }
  /// Named, within 0.1 s of `t_s`, within 0.2 mm of the burr as it was then.
  /// `also`: what else its nature breaks.
  static void expect_fault(const Found& found, const std::string& name, const Waypoint& then,
                           std::set<std::string> also = {}) {
    const auto measure = found.at(name);
    ASSERT_EQ(measure.value("met", true), false) << name << '\n' << found.measures.dump(1);
    also.insert(name);
    EXPECT_EQ(found.names, also);
    ASSERT_FALSE(measure["time_s"].is_null());
    EXPECT_NEAR(measure["time_s"].get<double>(), then.t_s, 0.1) << measure.dump(1);
    ASSERT_FALSE(measure["position_mm"].is_null());
    const auto at = measure["position_mm"].get<std::vector<double>>();
    EXPECT_LE(from_burr_mm({at[0], at[1], at[2]}, then), 0.2) << measure.dump(1);
  }

 private:
  void command(const std::string& arguments) {
    const auto result = test::sulcus_command(arguments, scratch_.path("err"));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  /// From the surface of the burr's head, a cylinder of 3 mm, outside or inside.
  static double from_burr_mm(const Eigen::Vector3d& at_mm, const Waypoint& p) {
    const double lean = p.lean_deg * std::numbers::pi / 180.0;
    const Eigen::Vector3d axis(std::sin(lean), 0.0, std::cos(lean));
    const Eigen::Vector3d from = at_mm - Eigen::Vector3d(p.x_mm, p.y_mm, p.z_mm);
    const double along = from.dot(axis);
    const double out = (from - along * axis).norm() - kBurrRadius_mm;
    const double below = std::max(-along, along - 3.0);
    return out > 0.0 && below > 0.0 ? std::hypot(out, below) : std::abs(std::max(out, below));
  }
  const ScratchFolder scratch_;
};

TEST_F(AssessedFaults, APerfectAttemptHasNone) {
  const Found found = attempt(in_turn(kSlot, kAway));
  EXPECT_EQ(found.names, std::set<std::string>{}) << found.measures.dump(1);
  EXPECT_EQ(found.at("greatest_depth_mm")["met"], true);
}

TEST_F(AssessedFaults, TooDeepAtOnePlace) {
  const Waypoint worst{3.9, 0.3, 0, -0.5};
  expect_fault(
      attempt(in_turn(
          in_turn(kSlot,
                  {{0.6, 0.3, 0, 0}, {0.9, 0.3, 0, -0.5}, {1.2, 0.3, 0, 0}, {1.8, -0.75, 0, 0}}),
          kAway)),
      "greatest_depth_mm", worst, {"over_mm", "greatest_roughness_um", "convergence_deg"});
}

TEST_F(AssessedFaults, ANeighbourNickedOnTheWayOut) {
  const Waypoint worst{4.2, 2.5, 0, 1.9};
  expect_fault(
      attempt(in_turn(
          kSlot,
          {{0.3, -0.75, 0, 1.9}, {1.2, 2.5, 0, 1.9}, {1.3, 2.7, 0, 1.9}, {2.0, 1.0, 0, 2.2}})),
      "neighbour_removed_mm3", worst);
}

TEST_F(AssessedFaults, TheTipUnderTheWall) {
  const Waypoint worst{4.6, 1.0, 0, 0.2, -20};
  const Found found = attempt(in_turn(kSlot, {{1, 0.5, 0, 0.3},
                                              {1.3, 0.5, 0, 0.3, -20},
                                              {1.6, 1.0, 0, 0.2, -20},
                                              {1.9, 0.5, 0, 0.3, -20},
                                              {2.2, 0.5, 0, 0.3},
                                              {2.6, 0.5, 0, 2.2}}));
  expect_fault(found, "undercut_mm2", worst, {"greatest_burr_angle_deg", "convergence_deg"});
}

TEST_F(AssessedFaults, OneWallThatLeansOut) {
  expect_fault(
      attempt(in_turn(
          kSlot,
          {{1, 0.5, 0, 0.2}, {1.6, 0.6, 0, 0.2, 14}, {2.2, 0.5, 0, 0.2}, {2.6, 0.5, 0, 2.2}})),
      "convergence_deg", {4.6, 0.6, 0, 0.2, 14}, {"greatest_burr_angle_deg"});
}

TEST_F(AssessedFaults, AWallLeftTooThin) {
  expect_fault(
      attempt(in_turn(kSlot,
                      {{0.75, 0.75, 0, 0}, {1.25, 1.35, 0, 0}, {2.1, 0, 0, 0}, {2.5, 0, 0, 2.2}})),
      "wall_left_mm", {4.25, 1.35, 0, 0}, {"over_mm"});
}

TEST_F(AssessedFaults, APush) {
  Script script{{0, -0.75, 0, 2},   {0.75, -0.75, 0, 0.5}, {0.77, -0.75, 0, 0.2},
                {1, -0.75, 0, 0.2}, {1.2, -0.75, 0, 0},    {2.2, 0.75, 0, 0},
                {3.2, -0.75, 0, 0}};
  expect_fault(attempt(in_turn(std::move(script), kAway)), "force_N", {0.77, -0.75, 0, 0.2});
}

TEST_F(AssessedFaults, CutBeyondTheGoal) {
  expect_fault(
      attempt(in_turn(
          kSlot, {{0.6, 0.2, 0, 0}, {0.9, 0.2, 0.35, 0}, {1.2, 0.2, 0, 0}, {1.6, 0.2, 0, 2.2}})),
      "over_mm", {3.9, 0.2, 0.35, 0}, {"greatest_roughness_um"});
}

TEST_F(AssessedFaults, AnEndThatWasLeft) {
  const Found found = attempt(
      {{0, -0.2, 0, 2}, {1, -0.2, 0, 0}, {2, 0.75, 0, 0}, {3, -0.2, 0, 0}, {3.5, -0.2, 0, 2.2}});
  EXPECT_EQ(found.names, std::set<std::string>{"under_mm"}) << found.measures.dump(1);
  const auto measure = found.at("under_mm");
  EXPECT_LE(measure["position_mm"][0], -0.7);
  EXPECT_GE(measure["position_mm"][0], -1.25);
  EXPECT_LE(std::abs(measure["position_mm"][1].get<double>()), 0.5);
  // What was never done has no moment: when the burr came as near as it did, on its way down and
  // until it stayed there, or when it was back.
  const double height_mm = measure["position_mm"][2], time_s = measure["time_s"];
  EXPECT_TRUE((time_s >= 0.5 * (2.0 - height_mm) && time_s <= 1.1) || std::abs(time_s - 3.0) <= 0.1)
      << measure.dump(1);
}

TEST_F(AssessedFaults, ABurrHeldAskew) {
  expect_fault(
      attempt(in_turn(
          kSlot, {{0.5, 0, 0, 0.05}, {0.8, 0, 0, 0.1, 6}, {1.1, 0, 0, 0.05}, {1.6, 0, 0, 2.2}})),
      "greatest_burr_angle_deg", {3.8, 0, 0, 0.1, 6});
}

TEST_F(AssessedFaults, AGrooveInAWall) {
  expect_fault(
      attempt(in_turn(
          kSlot, {{0.6, 0.2, 0, 0}, {0.75, 0.2, 0.2, 0}, {0.9, 0.2, 0, 0}, {1.4, 0.2, 0, 2.2}})),
      "greatest_roughness_um", {3.75, 0.2, 0.2, 0});
}

TEST_F(AssessedFaults, ASlotThatWasWidenedIsTimedWhenItWas) {
  const Found found =
      attempt(in_turn(in_turn(kSlot, {{0.5, -0.75, 0.4, 0}, {2.0, 0.75, 0.4, 0}}), kAway));
  const auto isthmus = found.at("isthmus_mm");
  EXPECT_NEAR(isthmus["value"].get<double>(), 1.4, 0.05);
  EXPECT_EQ(isthmus.value("met", true), false);
  ASSERT_FALSE(isthmus["time_s"].is_null());
  EXPECT_GT(isthmus["time_s"].get<double>(), 3.0) << "before, nothing was wrong";
  EXPECT_LT(isthmus["time_s"].get<double>(), 5.1);
}

}  // namespace
}  // namespace sulcus::assess_faults_test
