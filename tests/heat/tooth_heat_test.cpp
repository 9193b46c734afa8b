#include "engine/heat/tooth_heat.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/heat/thermal_tissues.hpp"
#include "engine/shapes/build_shape.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::tooth_heat_test {
namespace {

constexpr double kForEver = std::numeric_limits<double>::infinity();
constexpr double kVoxel_m = 0.05e-3;

/// A grid of 64^3 voxels of 0.05 mm, cells of four of them; `heat`: more keys of [heat].
Scene scene_with(const std::string& heat, const std::string& tissue = "enamel") {
  return test::parse("tissue = ['" + tissue +
                     "']\n[workpiece]\nshape = 'box'\nvoxel_mm = 0.05\ncells = [64, 64, 64]\n"
                     "[trajectory]\npoints_mm = [[0, 0, 9]]\n[cutting]\n[heat]\n" +
                     heat);
}

VoxelModel cube() {
  return test::block(Eigen::Vector3i::Constant(64), kVoxel_m, Cell::Constant(8),
                     Cell::Constant(56));
}

/// What is done to a tooth, 10 ticks to a stretch.
class Story {
 public:
  explicit Story(double rate_hz = 1000.0) : log(rate_hz, 0) {}

  /// So many stretches in which the burr turns at a place.
  void turn(int stretches, const Eigen::Vector3d& tip_world = {0, 0, 0}, double work_J = 0.0) {
    for (int i = 0; i < 10 * stretches; ++i) {
      TickRecord tick;
      CuttingRecord cutting;
      tick.tick = cutting.tick = tick_++;
      std::copy_n(tip_world.data(), 3, tick.tool_position_m);
      work_J_ += work_J / (10.0 * stretches);
      cutting.work_J = work_J_;
      cutting.spindle_rad_per_s = turns ? 1e4 : 0.0;
      log.add(tick, cutting);
    }
  }
  /// In the last tick.
  void cut(const VoxelGrid& grid, const Cell& c, std::uint16_t body = 0) {
    log.add(Edit{tick_ - 1, grid.linear(c), body, EditCause::kCut, 0});
  }

  HeatLog log;
  bool turns = true;

 private:
  std::uint64_t tick_ = 0;
  double work_J_ = 0.0;
};

TEST(ToothHeat, WhatNothingIsDoneToStaysAsItIs) {
  const Scene scene = scene_with("air_C = 37");
  ToothHeat tooth(scene, cube());
  Story story;
  story.turn(100);
  tooth.advance(story.log, kForEver);
  EXPECT_DOUBLE_EQ(*tooth.temperature_C({32, 32, 32}), 37.0);
  EXPECT_NEAR(tooth.result().cell_m, 0.2e-3, 1e-12);
  EXPECT_FALSE(tooth.result().pulp);
  EXPECT_FALSE(tooth.temperature_C({2, 2, 2})) << "nothing is there";
}

// The share of the work that the scene says, where the voxel was cut; and all of it.
TEST(ToothHeat, TheWorkHeatsTheToothWhereAVoxelWent) {
  const Scene scene = scene_with("air_C = 37\ntooth_share = 0.5");
  ToothHeat tooth(scene, cube());
  Story story;
  story.turn(1, {0, 0, 0}, 0.02);
  story.cut(cube().grid, {33, 33, 54});
  tooth.advance(story.log, kForEver);
  EXPECT_DOUBLE_EQ(tooth.result().given_J, 0.01);
  const double before = *tooth.temperature_C({33.5, 33.5, 53.5});
  EXPECT_GT(before, 100.0);
  EXPECT_NEAR(*tooth.temperature_C({33.5, 33.5, 13.5}), 37.0, 1e-6);
  story.turn(300);  // with hardly a loss, since air takes little in that time
  tooth.advance(story.log, kForEver);
  const double side_m = 48 * kVoxel_m;
  const double rise_K =
      0.01 / (thermal_material("enamel").capacity_J_per_m3K * side_m * side_m * side_m);
  EXPECT_NEAR(*tooth.temperature_C({31.5, 31.5, 31.5}) - 37.0, rise_K, 0.15 * rise_K);
}

TEST(ToothHeat, WorkWaitsForAVoxelThatGoes) {
  const Scene scene = scene_with("tooth_share = 1");
  ToothHeat tooth(scene, cube());
  Story story;
  story.turn(5, {0, 0, 0}, 0.03);
  tooth.advance(story.log, kForEver);
  EXPECT_EQ(tooth.result().given_J, 0.0);
  story.turn(1, {0, 0, 0}, 0.01);
  story.cut(cube().grid, {33, 33, 54});
  tooth.advance(story.log, kForEver);
  EXPECT_NEAR(tooth.result().given_J, 0.04, 1e-15);
}

TEST(ToothHeat, OfTwoBodiesEachHasWhatItsVoxelsTook) {
  Scene scene = scene_with("tooth_share = 1");
  BodySettings body;
  body.solid.voxel_m = 2.0 * kVoxel_m;  // eight times the volume
  scene.bodies.push_back(body);
  ToothHeat tooth(scene, cube());
  Story story;
  story.turn(1, {0, 0, 0}, 0.09);
  story.cut(cube().grid, {33, 33, 54});
  story.cut(cube().grid, {1, 1, 1}, 1);
  tooth.advance(story.log, kForEver);
  EXPECT_NEAR(tooth.result().given_J, 0.01, 1e-15);
}

// A cell goes when half of it has; what is cut then heats those beside it.
TEST(ToothHeat, CellsGoWithTheirVoxels) {
  const Scene scene = scene_with("tooth_share = 1\nair_C = 37");
  ToothHeat tooth(scene, cube());
  const VoxelGrid grid = cube().grid;
  Story story;
  story.turn(1);
  const Cell corner(32, 32, 52);  // of a cell at the top
  int cut = 0;
  for_each_cell(corner, corner + Cell(4, 4, 2), [&](const Cell& c) {
    if (cut++ < 31) story.cut(grid, c);
  });
  story.turn(1);
  tooth.advance(story.log, kForEver);
  const Eigen::Vector3d alone =
      (corner - Cell(0, 0, 0)).cast<double>() + Eigen::Vector3d(1.5, 1.5, 1.5);
  EXPECT_DOUBLE_EQ(*tooth.temperature_C(alone), 37.0);
  story.turn(1, {0, 0, 0}, 0.01);
  story.cut(grid, corner + Cell(3, 3, 1));  // the 32nd of its 64
  tooth.advance(story.log, kForEver);
  EXPECT_DOUBLE_EQ(tooth.result().given_J, 0.01);
  EXPECT_GT(*tooth.temperature_C(alone + Eigen::Vector3d(4, 0, 0)), 40.0);
  EXPECT_GT(*tooth.temperature_C(alone - Eigen::Vector3d(0, 0, 4)), 40.0);
}

/// After 60 s, in the middle of the cube.
double middle_C(const std::string& heat, const Eigen::Vector3d& tip_world = {0, 0, 0}) {
  const Scene scene = scene_with(heat);
  ToothHeat tooth(scene, cube());
  Story story;
  story.turn(6000, tip_world);
  tooth.advance(story.log, kForEver);
  return *tooth.temperature_C({31.5, 31.5, 31.5});
}

TEST(ToothHeat, ItTakesOnTheTemperatureOfWhatIsRoundIt) {
  EXPECT_NEAR(middle_C("water_ml_min = 50\nwater_C = 20"), 20.0, 0.1);
  EXPECT_NEAR(middle_C("water_ml_min = 50\nwater_C = 45"), 45.0, 0.1);
  EXPECT_NEAR(middle_C("gum_mm = 5\nair_C = 0"), 37.0, 1e-9);
  const double dry = middle_C("air_C = 20");
  EXPECT_LT(dry, 36.0);
  EXPECT_GT(dry, 20.5) << "air takes longer than water";
}

TEST(ToothHeat, WaterCoolsWhereTheBurrIsAndTurns) {
  EXPECT_NEAR(middle_C("water_ml_min = 50\nair_C = 37", {0, 0, 20e-3}), 37.0, 1e-9);
  const Scene scene = scene_with("water_ml_min = 50\nair_C = 37");
  ToothHeat tooth(scene, cube());
  Story story;
  story.turns = false;
  story.turn(500);
  tooth.advance(story.log, kForEver);
  EXPECT_NEAR(*tooth.temperature_C({31.5, 31.5, 31.5}), 37.0, 1e-9);
}

// All heat that the water takes goes with it, no warmer than the tooth: 0.001 ml/min cannot take
// more than flow times capacity times what it could be warmed by.
TEST(ToothHeat, LittleWaterTakesLittle) {
  const double side_m = 48 * kVoxel_m;
  const double capacity_J_per_K =
      thermal_material("enamel").capacity_J_per_m3K * side_m * side_m * side_m;
  const auto taken_J = [&](const std::string& flow) {
    return (37.0 - middle_C("air_C = 37\nwater_C = 17\nwater_ml_min = " + flow)) * capacity_J_per_K;
  };
  const double most_J = 0.001e-6 / 60.0 * 4.18e6 * 20.0 * 60.0;
  EXPECT_LT(taken_J("0.001"), most_J);
  EXPECT_GT(taken_J("0.001"), 0.85 * most_J);
  EXPECT_GT(taken_J("0.002"), 1.7 * taken_J("0.001"));
}

TEST(ToothHeat, TheGridsEdgeHoldsATooth) {
  const Scene scene = scene_with("air_C = 0");
  const VoxelModel whole =
      test::block(Eigen::Vector3i::Constant(64), kVoxel_m, Cell::Zero(), Cell::Constant(64));
  ToothHeat tooth(scene, whole);
  Story story;
  story.turn(3000);
  tooth.advance(story.log, kForEver);
  EXPECT_NEAR(*tooth.temperature_C({31.5, 31.5, 31.5}), 37.0, 1e-9);
}

// --- The pulp -----------------------------------------------------------------------------------

Scene molar_scene(const std::string& heat) {
  return test::parse(
      "tissue = ['enamel', 'dentine', 'pulp']\n[workpiece]\nshape = 'molar'\nvoxel_mm = 0.1\n"
      "cells = [128, 120, 208]\n[trajectory]\npoints_mm = [[0, 0, 9]]\n[cutting]\n[heat]\n" +
      heat);
}

/// Cuts a pit into the crown, 2 J in each of so many seconds.
Story drilled(const VoxelModel& molar, int seconds) {
  Story story;
  const VoxelGrid& grid = molar.grid;
  int z = grid.cells.z() - 1;
  const Cell above = grid.index_from_world({0.46e-3, -0.12e-3, 0}).cast<int>();
  for (int second = 0; second < seconds; ++second) {
    while (!molar.solid({above.x(), above.y(), z})) --z;
    for (int part = 0; part < 10; ++part) {
      const Cell c(above.x() + part % 3, above.y() + part / 3, z);
      story.turn(10, grid.centre_world(c), 0.2);
      if (molar.solid(c)) story.cut(grid, c);
    }
    --z;
  }
  return story;
}

TEST(ToothHeat, ThePulpsWallIsWatched) {
  const Scene scene = molar_scene("tooth_share = 0.5\ngum_mm = 1");
  const VoxelModel molar = build_shape(scene);
  const Story story = drilled(molar, 12);
  ToothHeat tooth(scene, molar);
  tooth.advance(story.log, kForEver);
  ASSERT_TRUE(tooth.result().pulp);
  const PulpHeat& pulp = *tooth.result().pulp;
  ASSERT_EQ(pulp.curve.size(), 1200u);
  double greatest = 0.0, over_s = 0.0;
  for (const PulpHeat::Point& point : pulp.curve) {
    greatest = std::max(greatest, point.warmest_K);
    if (point.warmest_K > kPulpLimit_K) over_s += 0.01;
    EXPECT_LE(point.coldest_K, point.warmest_K);
  }
  EXPECT_EQ(pulp.greatest_rise_K, greatest);
  EXPECT_GT(greatest, 0.3);
  EXPECT_NEAR(pulp.over_limit_s, over_s, 1e-9);
  // Heat comes late to what lies deep.
  EXPECT_GT(pulp.greatest_rise_s, 8.0);
  // It is the pulp's, and its roof's: what is nearest.
  const Cell at = molar.grid.index_from_world(pulp.greatest_rise_world).array().round().cast<int>();
  const Cell low = at - Cell::Constant(2);
  int of_pulp = 0;
  for_each_cell(low, low + Cell::Constant(5), [&](const Cell& c) {
    if (molar.solid(c) && molar.tissue(c) == 2) ++of_pulp;
  });
  EXPECT_GT(of_pulp, 10);
  EXPECT_GT(pulp.greatest_rise_world.z(), 0.0);
}

TEST(ToothHeat, TwiceTheWorkIsTwiceTheRise) {
  const VoxelModel molar = build_shape(molar_scene(""));
  const Story story = drilled(molar, 6);
  const auto rise = [&](const char* share) {
    const Scene scene = molar_scene("air_C = 37\ntooth_share = " + std::string(share));
    ToothHeat tooth(scene, molar);
    tooth.advance(story.log, kForEver);
    return tooth.result().pulp->greatest_rise_K;
  };
  EXPECT_NEAR(rise("0.2") / rise("0.1"), 2.0, 1e-6);
}

TEST(ToothHeat, InPartsAndWithAnyNumberOfThreadsItIsTheSame) {
  const Scene scene = molar_scene("water_ml_min = 15\nspray = 'mist'\ntooth_share = 0.5");
  const VoxelModel molar = build_shape(scene);
  const Story story = drilled(molar, 3);
  std::vector<std::vector<double>> curves;
  for (const int threads : {1, 2}) {
    tbb::task_arena(threads).execute([&] {
      ToothHeat tooth(scene, molar);
      for (double until_s = 0.37; threads == 2 && until_s < 3.0; until_s += 0.37) {
        tooth.advance(story.log, until_s);
      }
      tooth.advance(story.log, kForEver);
      std::vector<double>& curve = curves.emplace_back();
      for (const PulpHeat::Point& point : tooth.result().pulp->curve) {
        curve.push_back(point.warmest_K);
        curve.push_back(point.coldest_K);
      }
    });
  }
  EXPECT_EQ(curves[0], curves[1]);
}

}  // namespace
}  // namespace sulcus::tooth_heat_test
