#include "app/window/mouse_device.hpp"

#include <gtest/gtest.h>

namespace sulcus::mouse_device_test {
namespace {

TEST(MouseDevice, StaysUntilItIsToldAndThenGoesSmoothlyToTheLast) {
  Pose start;
  start.position = {1e-3, 0, 0};
  MouseDevice device(start, 1000.0);
  for (int tick = 0; tick < 5; ++tick) EXPECT_EQ(device.pose(tick)->position, start.position);
  Pose passed, wanted;
  passed.position = {0, 0, 9};
  wanted.position = {2e-3, 0, 0};
  wanted.orientation = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX());
  device.go_to(passed);
  device.go_to(wanted);
  double before_m = 1e-3;
  for (int tick = 5; tick < 400; ++tick) {
    const Pose pose = *device.pose(static_cast<std::uint64_t>(tick));
    EXPECT_GE(pose.position.x(), before_m);
    EXPECT_LT(pose.position.x() - before_m, 0.025e-3) << "a 50th of the way in a tick, no jump";
    EXPECT_EQ(pose.position.z(), 0.0) << "only the last counts";
    before_m = pose.position.x();
  }
  EXPECT_NEAR(before_m, 2e-3, 1e-6);
  EXPECT_LT(device.pose(400)->orientation.angularDistance(wanted.orientation), 1e-3);
}

}  // namespace
}  // namespace sulcus::mouse_device_test
