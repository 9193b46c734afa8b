// Cuts that miss their plan by a known distance, of meshes whose figures can be written down.
#include "engine/assessment/plan_match.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/assessment/turned_solid.hpp"

namespace sulcus::plan_match_test {
namespace {

using test::Profile;
using test::turned_mesh;

constexpr double kPi = std::numbers::pi;

Profile block() { return {{0, -3}, {3.5, -3}, {3.5, 3}, {0, 3}}; }

/// With a round hole in its upper face.
Profile hole(double radius, double depth) {
  return {{0, -3}, {3.5, -3}, {3.5, 3}, {radius, 3}, {radius, 3 - depth}, {0, 3 - depth}};
}

/// Of a hole of 1.2 mm radius, 1.5 mm deep, each mesh with other corners to the circle.
PlanMatch match(const Profile& after, double tolerance_mm = 0.3,
                const Eigen::Affine3d& placed = Eigen::Affine3d::Identity()) {
  return plan_match(turned_mesh(block(), 200, placed), turned_mesh(after, 331, placed),
                    turned_mesh(hole(1.2, 1.5), 270, placed),
                    {.insertion = placed.linear().col(2), .tolerance_mm = tolerance_mm})
      .value();
}

TEST(PlanMatch, OfACutAsItWasPlannedHasNoErrors) {
  const PlanMatch found = match(hole(1.2, 1.5));
  EXPECT_LT(found.over_mm.value, 0.005);
  EXPECT_LT(found.under_mm.value, 0.005);
  EXPECT_LT(found.error_mm, 0.001);
  EXPECT_EQ(found.within_tolerance, 1.0);
  EXPECT_NEAR(found.dice, 1.0, 0.002);
}

TEST(PlanMatch, AFloorTooDeepIsOver) {
  const PlanMatch found = match(hole(1.2, 1.8), 0.2);
  EXPECT_NEAR(found.over_mm.value, 0.3, 0.005);
  EXPECT_NEAR(found.over_mm.at_m.z(), 1.2e-3, 1e-6);
  EXPECT_LT(found.under_mm.value, 0.005);
  // The plan's wall, what goes on below it, the floor.
  const double wall = 2.4 * kPi * 1.5, lower = 2.4 * kPi * 0.3, floor = 1.44 * kPi;
  EXPECT_NEAR(found.error_mm, (0.15 * lower + 0.3 * floor) / (wall + lower + floor), 0.004);
  EXPECT_NEAR(found.error_95_mm, 0.3, 0.005);
  EXPECT_NEAR(found.within_tolerance, (wall + lower * 2.0 / 3.0) / (wall + lower + floor), 0.02)
      << "by pieces of 0.1 mm";
  EXPECT_NEAR(found.dice, 2.0 * 1.5 / (1.5 + 1.8), 0.003);
}

TEST(PlanMatch, AFloorTooHighIsUnder) {
  const PlanMatch found = match(hole(1.2, 1.1));
  EXPECT_NEAR(found.under_mm.value, 0.4, 0.005);
  EXPECT_NEAR(found.under_mm.at_m.z(), 1.9e-3, 1e-6);
  EXPECT_LT(found.over_mm.value, 0.005);
  EXPECT_NEAR(found.error_95_mm, 0.4, 0.005);
  EXPECT_NEAR(found.dice, 2.0 * 1.1 / (1.1 + 1.5), 0.003);
}

TEST(PlanMatch, AHoleTooWideIsOverByItsWall) {
  const PlanMatch found = match(hole(1.3, 1.5));
  EXPECT_NEAR(found.over_mm.value, 0.1, 0.03) << "within the pitch of the rays";
  EXPECT_LT(found.under_mm.value, 0.005);
  EXPECT_NEAR(found.dice, 2.0 * 1.44 / (1.44 + 1.69), 0.003);
}

TEST(PlanMatch, WhatWasNeverTouchedIsUnder) {
  // The old surface round a hole that is too narrow: as far from the plan's wall as its rim.
  const PlanMatch found = match(hole(0.5, 1.0));
  EXPECT_NEAR(found.under_mm.value, 0.7, 0.03);
  EXPECT_NEAR(1e3 * found.under_mm.at_m.head<2>().norm(), 0.5, 0.05);
  EXPECT_NEAR(found.dice, 2.0 * 0.25 / (0.25 + 1.44 * 1.5), 0.003);
}

TEST(PlanMatch, WhatWasCutElsewhereIsOverByHowFarItLies) {
  // A groove round the block's outside: its old surface lies furthest from the planned hole.
  const PlanMatch found = match({{0, -3},
                                 {3.5, -3},
                                 {3.5, 0},
                                 {3.2, 0},
                                 {3.2, 1},
                                 {3.5, 1},
                                 {3.5, 3},
                                 {1.2, 3},
                                 {1.2, 1.5},
                                 {0, 1.5}});
  EXPECT_NEAR(found.over_mm.value, std::hypot(3.5 - 1.2, 1.5), 0.06);
  EXPECT_NEAR(found.over_mm.at_m.z(), 0.0, 0.1e-3);
  EXPECT_LT(found.under_mm.value, 0.005);
}

TEST(PlanMatch, IsTheSameWhereverTheToothStands) {
  Eigen::Affine3d placed(Eigen::AngleAxisd(1.9, Eigen::Vector3d(0.3, -1, 0.2).normalized()));
  placed.pretranslate(Eigen::Vector3d(0.02, 0.03, -0.11));
  const PlanMatch here = match(hole(1.2, 1.8), 0.2), there = match(hole(1.2, 1.8), 0.2, placed);
  EXPECT_NEAR(there.over_mm.value, here.over_mm.value, 0.002);
  EXPECT_NEAR(there.error_mm, here.error_mm, 0.002);
  EXPECT_NEAR(there.within_tolerance, here.within_tolerance, 0.01);
  EXPECT_NEAR(there.dice, here.dice, 0.002);
  EXPECT_NEAR((placed.inverse() * there.over_mm.at_m).z(), 1.2e-3, 1e-6);
}

TEST(PlanMatch, ForgivesAPlanThatIsALittleOffWhereTheToothIsSteep) {
  const auto tooth = [](const Profile& cut) {
    Profile all{{0, -3}, {4.5, -3}, {2.5, 3}};
    all.insert(all.end(), cut.begin(), cut.end());
    return all;
  };
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  const Eigen::Affine3d off(Eigen::Translation3d(0.03e-3, -0.02e-3, 0.02e-3));
  const Profile cut = tooth({{1.2, 3}, {1.2, 1.5}, {0, 1.5}});
  const auto found = plan_match(turned_mesh(tooth({{0, 3}}), 200, here),
                                turned_mesh(cut, 331, here), turned_mesh(cut, 270, off), {});
  ASSERT_TRUE(found);
  EXPECT_LT(found->over_mm.value, 0.07);
  EXPECT_LT(found->under_mm.value, 0.07);
  EXPECT_LT(found->error_95_mm, 0.045);
  EXPECT_GT(found->dice, 0.95);
}

TEST(PlanMatch, OfAPlanThatRemovesNothingIsNone) {
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  EXPECT_FALSE(plan_match(turned_mesh(block(), 200, here), turned_mesh(hole(1, 1), 331, here),
                          turned_mesh(block(), 331, here), {}));
  // Nor where the tooth has a fissure, in which it is all round its own surface.
  const Profile fissured{{0, -3}, {3.5, -3}, {3.5, 3}, {1.53, 3}, {1.5, 2}, {1.47, 3}, {0, 3}};
  EXPECT_FALSE(plan_match(turned_mesh(fissured, 200, here), turned_mesh(hole(1, 1), 331, here),
                          turned_mesh(fissured, 331, here), {}));
}

}  // namespace
}  // namespace sulcus::plan_match_test
