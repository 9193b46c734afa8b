#include "haptics/device/device_port.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/core/fault.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::device_port_test {
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
  TickContext context_{scene_, burr_};
  HandedDevice device_;
  DevicePortState state_;
  std::uint64_t tick_ = 0;
  std::uint32_t faults_ = 0;
};

TEST_F(DevicePort, NoPoseIsBridgedFor20MsAtAnyRateAndThenTheForceFalls) {
  for (const double rate_hz : {300.0, 1000.0, 4000.0}) {
    state_ = {};
    scene_.haptics.rate_hz = rate_hz;
    scene_.device.emplace();
    device_.next = Pose{{1e-3, 0, 0}};
    const auto ticks_of = [&](double time_s) { return static_cast<int>(time_s * rate_hz + 1e-6); };
    for (int i = 0; i < ticks_of(0.2); ++i) render(read(), {1, 0, 0});
    ASSERT_EQ(state_.limiter.sent.force_N.x(), 1.0);
    device_.next.reset();
    for (int i = 0; i < ticks_of(0.02); ++i) {
      const DeviceReading bridged = read();
      EXPECT_EQ(bridged.faults, kFaultPoseBridged);
      EXPECT_FALSE(bridged.silent);
      EXPECT_TRUE(bridged.slides);
      EXPECT_EQ(bridged.pose.position.x(), 1e-3);
      render(bridged, {1, 0, 0});
      EXPECT_EQ(state_.limiter.sent.force_N.x(), 1.0);
    }
    // Falls from the tick after the first silent one on: never by more than its part of 50 ms.
    double last_N = 1.0;
    for (int i = 0; i <= ticks_of(0.05) + 1; ++i) {
      const DeviceReading silent = read();
      EXPECT_EQ(silent.faults, kFaultDeviceSilent);
      EXPECT_TRUE(silent.silent);
      EXPECT_FALSE(silent.slides);
      render(silent, {1, 0, 0});
      const double now_N = state_.limiter.sent.force_N.x();
      EXPECT_LE(last_N - now_N, 1.0 / (0.05 * rate_hz) + 1e-9);
      last_N = now_N;
    }
    EXPECT_NEAR(last_N, 0.0, 1e-9);
    // What comes next is no way that the tool has slid.
    device_.next = Pose{{2e-3, 0, 0}};
    const DeviceReading back = read();
    EXPECT_FALSE(back.silent);
    EXPECT_FALSE(back.slides);
    EXPECT_EQ(back.faults, 0u);
    EXPECT_TRUE(read().slides);
  }
}

TEST_F(DevicePort, BeforeTheFirstPoseThereIsNothingToBridge) {
  device_.next.reset();
  const DeviceReading silent = read();
  EXPECT_TRUE(silent.silent);
  EXPECT_EQ(silent.faults, kFaultDeviceSilent);
}

TEST_F(DevicePort, ADeviceThatDoesNotAnswerKeepsItsPoseAndLosesItsForce) {
  scene_.device.emplace();
  device_.next = Pose{{1e-3, 0, 0}};
  for (int i = 0; i < 200; ++i) render(read(), {1, 0, 0});
  EXPECT_EQ(state_.limiter.sent.force_N.x(), 1.0);
  device_.next.reset();
  for (int i = 0; i < 72; ++i) {
    const DeviceReading silent = read();
    EXPECT_EQ(silent.pose.position.x(), 1e-3);
    EXPECT_EQ(silent.faults, i < 20 ? kFaultPoseBridged : kFaultDeviceSilent);
    render(silent, {1, 0, 0});
  }
  EXPECT_EQ(state_.limiter.sent.force_N.x(), 0.0);
}

TEST_F(DevicePort, MoreThan5MmInATickIsAJumpAtAnyRateWhateverGivesThePoses) {
  burr_.head_length_m = 4e-3;
  for (const double rate_hz : {300.0, 1000.0, 4000.0}) {
    for (const bool is_device : {false, true}) {
      state_ = {};
      scene_.haptics.rate_hz = rate_hz;
      scene_.device.reset();
      if (is_device) scene_.device.emplace();
      device_.next = Pose{};
      EXPECT_FALSE(read().jumped) << "the first";
      device_.next = Pose{{0, 0, 5.1e-3}};
      const DeviceReading jumped = read();
      EXPECT_TRUE(jumped.jumped);
      EXPECT_FALSE(jumped.slides);
      EXPECT_EQ(jumped.faults, kFaultDeviceJumped);
      device_.next = Pose{{0, 0, 0.2e-3}};
      const DeviceReading fast = read();
      EXPECT_FALSE(fast.jumped) << "fast, but a hand's";
      EXPECT_TRUE(fast.slides);
      // Turned about: the tip stays, the head's other end goes 8 mm.
      device_.next->orientation = Eigen::Quaterniond(0, 0, 0, 1);
      EXPECT_TRUE(read().jumped);
    }
  }
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
  EXPECT_NEAR(state_.limiter.sent.force_N.x(), scene_.device->force_limit_N, 1e-12);
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

TEST_F(DevicePort, BehindADeviceWhatIsNotFiniteIsZeroForceAtOnceAndLeavesNoTrace) {
  scene_.device.emplace();
  scene_.device->torque_limit_Nm = 0.1;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Wrench whole{{3, 0, 0}, {0.09, 0, 0}};
  std::vector<Wrench> broken(5, whole);  // the last with a pose that is not finite
  broken[0].force_N.x() = kNan;
  broken[1].force_N.y() = kInfinity;
  broken[2].force_N.z() = -kInfinity;
  broken[3].torque_Nm.y() = kNan;
  for (const bool controller : {false, true}) {
    scene_.device->passivity_controller = controller;
    for (std::size_t kind = 0; kind < broken.size(); ++kind) {
      state_ = {};
      faults_ = 0;
      device_.next = Pose{};
      const auto render_whole = [&] {
        return render_wrench(context_, read(), whole, state_, faults_);
      };
      for (int i = 0; i < 200; ++i) render_whole();
      ASSERT_EQ(state_.limiter.sent.force_N.x(), 3.0) << "many steps of the limit";
      ASSERT_EQ(state_.limiter.sent.torque_Nm.x(), 0.09);
      if (kind == 4) device_.next->position.x() = kNan;
      const DeviceReading reading = read();
      faults_ |= reading.faults;
      const Wrench sent = render_wrench(context_, reading, broken[kind], state_, faults_);
      EXPECT_TRUE(sent.force_N.isZero(0.0) && sent.torque_Nm.isZero(0.0)) << kind;
      EXPECT_TRUE(state_.limiter.sent.force_N.isZero(0.0)) << kind;
      EXPECT_EQ(faults_, kFaultNotFinite);
      EXPECT_EQ(state_.limiter.not_finite_ticks, 1u);
      faults_ = 0;
      device_.next = Pose{};
      EXPECT_TRUE(render_whole().force_N.allFinite()) << "nothing of it stays";
      EXPECT_TRUE(std::isfinite(state_.passivity.energy_J));
      EXPECT_TRUE(state_.buzz.furthest_N.allFinite());
      EXPECT_EQ(faults_, 0u);
    }
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
}  // namespace sulcus::device_port_test
