#include "haptics/device/device_placement.hpp"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"

namespace sulcus::device_placement_test {
namespace {

const Pose kSomewhere{{1e-3, -2e-3, 3e-3}, Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5)};

bool same_bits(const Pose& a, const Pose& b) {
  return std::memcmp(a.position.data(), b.position.data(), 3 * sizeof(double)) == 0 &&
         std::memcmp(a.orientation.coeffs().data(), b.orientation.coeffs().data(),
                     4 * sizeof(double)) == 0;
}

TEST(PlacedDevice, WhatIsPlacedNowhereIsAsItWasToTheBit) {
  PlacedDevice placed({}, {0.1, 0.2, 0.3});
  EXPECT_TRUE(same_bits(placed.to_scene(kSomewhere, false), kSomewhere));
  const Wrench wrench{{1.1, 2.2, 3.3}, {0.1, 0.2, 0.3}};
  EXPECT_EQ(placed.to_device(wrench).force_N, wrench.force_N);
}

// Power that the hand puts in is power that the scene takes, but for the scale of the way.
TEST(PlacedDevice, ForcesTurnBackAsWaysTurn) {
  DevicePlacement placement;
  placement.rotation = Eigen::Vector3d(20, -50, 110) * kDegree;
  placement.scale = 0.25;
  placement.position_m = {0.01, 0.02, 0.03};
  PlacedDevice placed(placement, {0, 0, 0});
  const Eigen::Vector3d step(1e-4, 3e-4, -2e-4), force(0.3, -1.2, 0.7);
  Pose moved = kSomewhere;
  moved.position += step;
  const Eigen::Vector3d scene_step =
      -placed.to_scene(kSomewhere, false).position + placed.to_scene(moved, false).position;
  const Wrench own = placed.to_device({force, force});
  EXPECT_NEAR(scene_step.dot(force), 0.25 * step.dot(own.force_N), 1e-15);
  EXPECT_NEAR(scene_step.norm(), 0.25 * step.norm(), 1e-15);
  EXPECT_NEAR(own.torque_Nm.norm(), force.norm(), 1e-12);
  // The tool's axis turns with it.
  const Eigen::Vector3d axis = kSomewhere.orientation * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d turned =
      placed.to_scene(kSomewhere, false).orientation * Eigen::Vector3d::UnitY();
  EXPECT_NEAR(turned.dot(force), axis.dot(own.force_N), 1e-12);
}

TEST(PlacedDevice, RecentredItIsAtTheStartAndAgainWhenAsked) {
  DevicePlacement placement;
  placement.recentre = true;
  const Eigen::Vector3d start(0.1, 0.2, 0.3);
  PlacedDevice placed(placement, start);
  EXPECT_LT((placed.to_scene(kSomewhere, false).position - start).norm(), 1e-15);
  Pose moved = kSomewhere;
  moved.position.x() += 2e-3;
  EXPECT_NEAR(placed.to_scene(moved, false).position.x(), start.x() + 2e-3, 1e-15);
  placed.recentre();
  EXPECT_LT((placed.to_scene(moved, false).position - start).norm(), 1e-15);
}

// Held over and over, whatever the hand does, the tip does not creep.
TEST(PlacedDevice, TheClutchHoldsTheTipExactly) {
  PlacedDevice placed({}, {0, 0, 0});
  const Eigen::Vector3d held = placed.to_scene(kSomewhere, false).position;
  Pose hand = kSomewhere;
  for (int i = 0; i < 1000; ++i) {
    hand.position += Eigen::Vector3d(1.1e-5, 0.7e-5 * std::sin(i), -0.3e-5);
    ASSERT_EQ(placed.to_scene(hand, true).position, held) << i;
  }
  ASSERT_EQ(placed.to_scene(hand, false).position, held);
  hand.position.x() += 1e-3;
  EXPECT_NEAR(placed.to_scene(hand, false).position.x(), held.x() + 1e-3, 1e-15);
}

TEST(PlacedDevice, RecentredUnderTheClutchItGoesOnFromTheStart) {
  const Eigen::Vector3d start(0.1, 0.2, 0.3);
  PlacedDevice placed({}, start);
  (void)placed.to_scene(kSomewhere, false);
  Pose hand = kSomewhere;
  hand.position.x() += 4e-3;
  (void)placed.to_scene(hand, true);
  placed.recentre();
  EXPECT_EQ(placed.to_scene(hand, true).position, start);
  hand.position.y() -= 7e-3;
  EXPECT_EQ(placed.to_scene(hand, true).position, start);
  EXPECT_EQ(placed.to_scene(hand, false).position, start) << "as it is let go";
  hand.position.x() += 1e-3;
  EXPECT_NEAR(placed.to_scene(hand, false).position.x(), start.x() + 1e-3, 1e-15);
}

// Before there was a pose there is nothing to hold.
TEST(PlacedDevice, AClutchThatIsHeldFromTheStartTakesTheFirstPose) {
  PlacedDevice placed({}, {0, 0, 0});
  EXPECT_EQ(placed.to_scene(kSomewhere, true).position, kSomewhere.position);
}

}  // namespace
}  // namespace sulcus::device_placement_test
