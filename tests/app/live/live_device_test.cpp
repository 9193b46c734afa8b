#include "app/live/live_device.hpp"

#include <optional>

#include <gtest/gtest.h>

namespace sulcus::live_device_test {
namespace {

/// A hand that is always there, and counts what is done to it.
class Hand final : public Device {
 public:
  std::optional<Pose> pose(std::uint64_t) noexcept override { return Pose{}; }
  std::uint32_t burr() noexcept override { return says; }
  double pedal() noexcept override { return 0.5; }
  void apply(const Wrench& wrench) noexcept override { felt_N = wrench.force_N.z(); }
  bool fade() noexcept override { return ++fades < 3; }
  void release() noexcept override { ++releases; }

  std::uint32_t says = kSameBurr;
  double felt_N = 0.0;
  int fades = 0, releases = 0;
};

const Wrench kForce{{0.0, 0.0, 2.0}, {0.0, 0.0, 0.0}};

/// Ticks of a part until it gives a pose, at most so many.
int ticks_without_pose(LiveDevice& device, int most) {
  int ticks = 0;
  while (ticks < most && !device.pose(0)) ++ticks;
  return ticks;
}

// However a part ends, the force is taken off: a window may be closed while it still falls.
TEST(LiveDevice, TheForceFadesAtTheEndOfEveryPart) {
  Hand hand;
  LiveDevice device(hand, 1000.0, true, true, 3);
  device.begin_part(false, 0);
  device.end_part();
  EXPECT_TRUE(device.goes_on());
  EXPECT_TRUE(device.fade());
  EXPECT_EQ(hand.fades, 1);
  device.release();
  EXPECT_EQ(hand.releases, 0) << "it is held on to";
  device.finish();
  EXPECT_EQ(hand.releases, 1);
}

TEST(LiveDevice, APartThatIsTheLastLetsGoOnce) {
  Hand hand;
  LiveDevice device(hand, 1000.0, true, true, 3);
  device.begin_part(false, 0);
  device.release();
  device.finish();
  EXPECT_EQ(hand.releases, 1);
}

// What was refused, or changed by a key meanwhile, is not asked for over and over.
TEST(LiveDevice, ABurrIsAskedForWhenTheDeviceSaysAnotherOne) {
  Hand hand;
  LiveDevice device(hand, 1000.0, true, true, 3);
  device.begin_part(false, 0);
  hand.says = 0;
  (void)device.pose(0);
  EXPECT_FALSE(device.is_gone()) << "it is the scene's";
  hand.says = 2;
  EXPECT_FALSE(device.pose(1));
  EXPECT_TRUE(device.is_gone());
  EXPECT_EQ(device.wanted_burr(), 2u);
  device.begin_part(true, 2);
  for (int tick = 0; tick < 300; ++tick) (void)device.pose(0);
  EXPECT_FALSE(device.is_gone());
  EXPECT_EQ(device.wanted_burr(), kSameBurr);
  hand.says = 3;  // there is none
  (void)device.pose(0);
  EXPECT_FALSE(device.is_gone());
  hand.says = 1;
  (void)device.pose(0);
  EXPECT_EQ(device.wanted_burr(), 1u);
}

// A key has changed it meanwhile.
TEST(LiveDevice, TheBurrThatIsInIsNotChangedTo) {
  Hand hand;
  LiveDevice device(hand, 1000.0, true, true, 3);
  hand.says = 0;
  device.begin_part(false, 0);
  (void)device.pose(0);
  device.begin_part(true, 1);
  hand.says = 1;
  (void)device.pose(0);
  EXPECT_FALSE(device.is_gone());
  EXPECT_EQ(device.wanted_burr(), kSameBurr);
}

TEST(LiveDevice, WhatAFallLeavesIsTakenOffBetweenParts) {
  Hand hand;
  LiveDevice device(hand, 1000.0, true, true, 3);
  device.begin_part(false, 0);
  device.apply(kForce);
  device.end_part();
  device.release();
  EXPECT_EQ(hand.felt_N, 0.0);
  EXPECT_EQ(hand.releases, 0);
}

// In the next part nothing is felt until the force of before has been forgotten.
TEST(LiveDevice, APartThatFollowsBeginsAsAfterASilence) {
  Hand hand;
  LiveDevice device(hand, 1000.0, true, true, 3);
  device.begin_part(true, 0);
  device.apply(kForce);
  EXPECT_EQ(hand.felt_N, 0.0);
  EXPECT_EQ(ticks_without_pose(device, 1000), 100);
  device.apply(kForce);
  EXPECT_EQ(hand.felt_N, 2.0);

  LiveDevice mouse(hand, 1000.0, false, true, 0);
  mouse.begin_part(true, 0);
  EXPECT_EQ(ticks_without_pose(mouse, 1000), 0) << "nobody feels it";
}

TEST(LiveDevice, SwitchAndPedalAreOneSpeedAndALetGoHandGivesNoPose) {
  Hand hand;
  LiveDevice device(hand, 1000.0, true, true, 0);
  device.begin_part(false, 0);
  device.set_pedal(0.5);
  EXPECT_EQ(device.pedal(), 0.25);
  EXPECT_TRUE(device.pose(0));
  device.let_go(true);
  EXPECT_FALSE(device.pose(1));
  device.let_go(false);
  EXPECT_TRUE(device.pose(2));
}

}  // namespace
}  // namespace sulcus::live_device_test
