#include "haptics/device/device.hpp"

#include <array>

#include <gtest/gtest.h>

namespace sulcus::device_test {
namespace {

using Eigen::Vector3d;

TEST(ScriptedDevice, FollowsItsTrajectoryByTheTicksNumberWhateverTheForce) {
  TrajectorySettings settings;
  settings.points_m = {Vector3d(0, 0, 0), Vector3d(1e-3, 0, 0)};
  settings.speed_m_per_s = 1e-3;
  const Trajectory trajectory = make_trajectory(settings);
  ScriptedDevice device(trajectory, 500.0);
  EXPECT_EQ(device.pose(0)->position, Vector3d(0, 0, 0));
  EXPECT_TRUE(device.pose(250)->position.isApprox(Vector3d(0.5e-3, 0, 0), 1e-12));
  device.apply({Vector3d(100, 0, 0), Vector3d(0, 0, 0)});
  EXPECT_TRUE(device.pose(100)->position.isApprox(Vector3d(0.2e-3, 0, 0), 1e-12));
  EXPECT_EQ(device.pose(9000)->position, Vector3d(1e-3, 0, 0));
}

TEST(PlaybackDevice, GivesThePoseOfEachTick) {
  std::array<std::optional<Pose>, 3> poses;
  for (const int i : {0, 2}) poses[static_cast<std::size_t>(i)] = Pose{Vector3d(i, 0, 0)};
  PlaybackDevice device(poses);
  EXPECT_EQ(device.pose(2)->position.x(), 2.0);
  device.apply({Vector3d(100, 0, 0), Vector3d(0, 0, 0)});
  EXPECT_EQ(device.pose(0)->position.x(), 0.0);
  EXPECT_FALSE(device.pose(1)) << "it did not answer";
}

}  // namespace
}  // namespace sulcus::device_test
