#include "haptics/device/device_port.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/recording/tick_record.hpp"
#include "tests/support/tools.hpp"

namespace sulcus {
namespace {

using Eigen::Vector3d;

/// What a test puts there.
class HandedDevice final : public Device {
 public:
  std::optional<Pose> pose(std::uint64_t) noexcept override { return next; }
  void apply(const Wrench&) noexcept override {}
  std::optional<Pose> next = Pose{};
};

class DevicePort : public testing::Test {
 protected:
  DevicePort() {
    scene_.tissues = test::one_tissue();
    burr_.reference_m = 40e-3;
  }
  DeviceReading read() { return read_pose(context_, device_, tick_++, state_); }
  Wrench render(const DeviceReading& reading, const Vector3d& force_N) {
    return render_wrench(context_, reading, {force_N, Vector3d::Zero()}, state_, faults_);
  }

  Scene scene_;
  Burr burr_;
  TickContext context_{scene_, burr_, {}};
  HandedDevice device_;
  DevicePortState state_;
  std::uint64_t tick_ = 0;
  std::uint32_t faults_ = 0;
};

TEST_F(DevicePort, ADeviceThatDoesNotAnswerKeepsItsPoseAndLosesItsForce) {
  scene_.device.emplace();
  device_.next = Pose{{1e-3, 0, 0}};
  for (int i = 0; i < 200; ++i) render(read(), {1, 0, 0});
  EXPECT_EQ(state_.edge.sent.force_N.x(), 1.0);
  device_.next.reset();
  for (int i = 0; i < 30; ++i) {
    const DeviceReading silent = read();
    EXPECT_EQ(silent.pose.position.x(), 1e-3);
    EXPECT_EQ(silent.faults, kFaultDeviceSilent);
    render(silent, {1, 0, 0});
  }
  EXPECT_EQ(state_.edge.sent.force_N.x(), 0.0);
}

TEST_F(DevicePort, AJumpIsOneOfADeviceOnlyAndStartsTheForceAnew) {
  const Pose far{{50e-3, 0, 0}};
  read();
  device_.next = far;
  EXPECT_FALSE(read().jumped) << "a trajectory may go where it likes";
  scene_.device.emplace();
  device_.next = Pose{};
  const DeviceReading jumped = read();
  EXPECT_TRUE(jumped.jumped);
  EXPECT_EQ(jumped.faults, kFaultDeviceJumped);
  device_.next = Pose{{4.9e-3, 0, 0}};
  EXPECT_FALSE(read().jumped) << "fast, but a hand's";
}

TEST_F(DevicePort, APoseThatIsNotFiniteIsAFaultAndTheLastOneStands) {
  device_.next = Pose{{1e-3, 0, 0}};
  read();
  device_.next = Pose{{std::numeric_limits<double>::quiet_NaN(), 0, 0}};
  const DeviceReading broken = read();
  EXPECT_EQ(broken.faults, kFaultNotFinite);
  EXPECT_EQ(broken.pose.position.x(), 1e-3);
}

TEST_F(DevicePort, ATrajectoryHasNoLimitsAndADeviceItsOwn) {
  const Vector3d asked(30, 0, 0);
  EXPECT_EQ(render(read(), asked).force_N, asked);
  scene_.device.emplace();
  for (int i = 0; i < 200; ++i) render(read(), asked);
  EXPECT_NEAR(state_.edge.sent.force_N.x(), scene_.device->force_limit_N, 1e-12);
}

TEST_F(DevicePort, TheObserverIsAlwaysThereAndTheControllerWhereItIsAskedFor) {
  // Into a spring and out again: held over a tick, it gives out more than it took.
  for (const bool controller : {false, true}) {
    state_ = {};
    scene_.device.emplace();
    scene_.device->passivity_controller = controller;
    Pose pose;
    for (int i = -110; i < 40; ++i) {
      pose.position.x() = (40 - std::abs(i)) * 50e-6;  // the ramp of the start is over in contact
      device_.next = pose;
      render(read(), {-1e3 * std::max(0.0, pose.position.x()), 0, 0});
    }
    EXPECT_GT(state_.passivity.given_out_J(), controller ? -1.0 : 1e-5);
    EXPECT_EQ(state_.passivity.damped_ticks > 0, controller);
  }
}

TEST_F(DevicePort, AForceThatIsNotFiniteIsNotSent) {
  const Wrench sent = render(read(), {std::numeric_limits<double>::infinity(), 0, 0});
  EXPECT_TRUE(sent.force_N.isZero(0.0));
  EXPECT_EQ(faults_ & kFaultNotFinite, kFaultNotFinite);
}

TEST_F(DevicePort, BuzzIsSaidOfALoopOnly) {
  for (const bool coupled : {false, true}) {
    state_ = {};
    faults_ = 0;
    if (coupled) scene_.coupling.emplace();
    for (int i = 0; i < 100; ++i) render(read(), {i / 5 % 2 ? 1.0 : -1.0, 0, 0});
    EXPECT_EQ((faults_ & kFaultBuzz) != 0, coupled);
  }
}

}  // namespace
}  // namespace sulcus
