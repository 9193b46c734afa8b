#include "haptics/device/simulated_device.hpp"

#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "tests/support/allocation_count.hpp"

namespace sulcus::simulated_device_test {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kReference = 40e-3;  // m

Quaterniond about_x(double angle) { return {std::cos(angle / 2), std::sin(angle / 2), 0.0, 0.0}; }

/// Nothing acts on it but what a test says: no friction, no encoders, no damping, no hand.
DeviceSettings bare() {
  DeviceSettings d;
  d.mass_kg = 0.05;
  d.damping_N_s_per_m = 0.0;
  d.friction_N = 0.0;
  d.resolution_m = 0.0;
  d.hand = {};
  d.hand.damping_N_s_per_m = 0.0;
  d.hand.stiffness_N_per_m = 0.0;
  d.hand.turning_damping_Nm_s_per_rad = 0.0;
  d.hand.turning_stiffness_Nm_per_rad = 0.0;
  return d;
}

/// The same with an inertia.
DeviceSettings bare_turning() {
  DeviceSettings d = bare();
  d.inertia_kg_m2 = 1e-4;
  return d;
}

/// A device with the trajectory of its hand.
struct Rig {
  Rig(const DeviceSettings& settings, std::vector<TimedPose> poses, double rate_hz = 1000.0)
      : trajectory(std::move(poses)), device(settings, trajectory, rate_hz, kReference) {}
  explicit Rig(const DeviceSettings& settings, double rate_hz = 1000.0)
      : Rig(settings, {TimedPose{}}, rate_hz) {}

  /// Ticks up to the one of that number, each answered with the wrench.
  std::optional<Pose> run(std::uint64_t to, const Wrench& wrench = {}) {
    std::optional<Pose> pose;
    for (; next <= to; ++next) {
      pose = device.pose(next);
      device.apply(wrench);
    }
    return pose;
  }
  const SimulatedDeviceState& state() const { return device.state(); }

  Trajectory trajectory;
  SimulatedDevice device;
  std::uint64_t next = 0;
};

Wrench force(double x, double y, double z) { return {Vector3d(x, y, z), Vector3d::Zero()}; }
Wrench torque(double x, double y, double z) { return {Vector3d::Zero(), Vector3d(x, y, z)}; }

TEST(SimulatedDevice, LeftAloneItStaysWhereTheHandWantsTheTip) {
  TimedPose start;
  start.world_from_tool = {Vector3d(1e-3, 2e-3, 3e-3), about_x(0.5)};
  for (const bool turns : {false, true}) {
    Rig rig(turns ? bare_turning() : bare(), {start});
    const auto pose = rig.run(100);
    EXPECT_TRUE(pose->position.isApprox(start.world_from_tool.position, 1e-12));
    EXPECT_TRUE(pose->orientation.isApprox(start.world_from_tool.orientation, 1e-12));
    EXPECT_TRUE(
        rig.state().position.isApprox(start.world_from_tool.point({0, kReference, 0}), 1e-12));
  }
}

TEST(SimulatedDevice, AMassUnderAForceMovesAsInTheTextbook) {
  for (const double rate_hz : {300.0, 1000.0, 50e3}) {
    Rig rig(bare(), rate_hz);
    rig.run(50, force(0.1, 0, 0));
    const double t = 50 / rate_hz;
    EXPECT_NEAR(rig.state().position.x(), 0.5 * 0.1 / 0.05 * t * t, 1e-12) << rate_hz;
    EXPECT_NEAR(rig.state().velocity_m_per_s.x(), 0.1 / 0.05 * t, 1e-12) << rate_hz;
  }
}

TEST(SimulatedDevice, OnTheHandsSpringItSwingsAsInTheTextbook) {
  DeviceSettings d = bare();
  d.damping_N_s_per_m = 0.3;
  d.hand.mass_kg = 0.03;
  d.hand.damping_N_s_per_m = 0.7;
  d.hand.stiffness_N_per_m = 300.0;
  Rig rig(d);
  const double m = 0.08, b = 1.0, k = 300.0, rest = 0.5 / k;
  const double decay = b / (2 * m), w = std::sqrt(k / m - decay * decay);
  for (std::uint64_t tick = 0; tick < 300; ++tick) {
    rig.run(tick, force(0, 0.5, 0));
    const double t = 1e-3 * static_cast<double>(tick);
    const double x =
        rest * (1 - std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)));
    ASSERT_NEAR(rig.state().position.y() - kReference, x, 1e-4 * rest) << tick;
  }
}

TEST(SimulatedDevice, TheHandDragsItAlongByItsSpringAndDamper) {
  // At a constant speed only the device's own damping holds back, by what the spring is stretched.
  DeviceSettings d = bare();
  d.damping_N_s_per_m = 2.0;
  d.hand.damping_N_s_per_m = 8.0;
  d.hand.stiffness_N_per_m = 300.0;
  TimedPose end;
  end.time_s = 1.0;
  end.world_from_tool.position = Vector3d(0, 0, 20e-3);
  Rig rig(d, {TimedPose{}, end});
  const auto pose = rig.run(900);
  EXPECT_NEAR(rig.state().velocity_m_per_s.z(), 20e-3, 1e-8);
  EXPECT_NEAR(pose->position.z(), 18e-3 - 2.0 * 20e-3 / 300.0, 1e-8);
}

TEST(SimulatedDevice, AForceIsHeldFromItsTickOnOrFromTheNext) {
  for (const int delay : {0, 1}) {
    DeviceSettings d = bare();
    d.delay_ticks = delay;
    Rig rig(d);
    rig.run(0, force(1, 0, 0));
    EXPECT_EQ(rig.state().held.force_N.x(), delay == 0 ? 1.0 : 0.0);
    rig.run(1, force(0, 0, 0));
    EXPECT_EQ(rig.state().velocity_m_per_s.x() > 0.0, delay == 0);
    rig.run(2, force(0, 0, 0));
    EXPECT_NEAR(rig.state().velocity_m_per_s.x(), 1.0 / 0.05 * 1e-3, 1e-12) << "one tick of it";
    rig.run(3, force(0, 0, 0));
    EXPECT_NEAR(rig.state().velocity_m_per_s.x(), 1.0 / 0.05 * 1e-3, 1e-12) << "and no more";
  }
}

TEST(SimulatedDevice, FrictionHoldsAgainstLessThanItself) {
  DeviceSettings d = bare();
  d.friction_N = 0.05;
  Rig rig(d);
  rig.run(200, force(0.03, 0.03, 0.02));
  EXPECT_EQ(rig.state().velocity_m_per_s, Vector3d::Zero());
  EXPECT_EQ(rig.state().position, Vector3d(0, kReference, 0));
  rig.run(300, force(0.04, 0.04, 0.02));  // 0.06 N
  const Vector3d along = Vector3d(0.04, 0.04, 0.02) / 0.06;
  EXPECT_TRUE(rig.state().velocity_m_per_s.isApprox((0.01 / 0.05 * 99e-3) * along, 1e-9))
      << "the rest of the force, its 99 ticks: " << rig.state().velocity_m_per_s.transpose();
}

TEST(SimulatedDevice, FrictionBringsItToRestAndNeverTurnsItBack) {
  DeviceSettings d = bare();
  d.friction_N = 0.05;
  Rig rig(d);
  rig.run(20, force(1, 0, 0));
  rig.run(21);
  const double speed = rig.state().velocity_m_per_s.x();
  ASSERT_GT(speed, 0.1);
  rig.run(21 + 100);
  EXPECT_NEAR(rig.state().velocity_m_per_s.x(), speed - 0.05 / 0.05 * 0.1, 1e-9);
  double last = rig.state().velocity_m_per_s.x();
  for (std::uint64_t tick = 122; tick < 1000; ++tick) {
    rig.run(tick);
    const double now = rig.state().velocity_m_per_s.x();
    ASSERT_GE(now, 0.0);
    ASSERT_TRUE(now < last || now == 0.0);
    last = now;
  }
  EXPECT_EQ(last, 0.0);
}

TEST(SimulatedDevice, TheHandPushesFromTheFirstForceFeltAndByARamp) {
  for (const int delay : {0, 1}) {
    DeviceSettings d = bare();
    d.delay_ticks = delay;
    d.hand.push_N = 2.0;
    d.hand.push_direction = -Vector3d::UnitZ();
    d.hand.push_ramp_s = 0.1;
    Rig rig(d);
    rig.run(49, force(0.009, 0, 0));
    EXPECT_FALSE(rig.state().pushing);
    EXPECT_EQ(rig.state().velocity_m_per_s.z(), 0.0);
    rig.run(50, force(0.011, 0, 0));
    rig.run(51 + 200);
    EXPECT_TRUE(rig.state().pushing);
    const auto since = static_cast<std::uint64_t>(50 + delay);
    EXPECT_EQ(rig.state().pushing_since, since);
    // Half the ramp's time at full strength is missing.
    const double pushed_s = 1e-3 * static_cast<double>(251 - since) - 0.05;
    EXPECT_NEAR(rig.state().velocity_m_per_s.z(), -2.0 / 0.05 * pushed_s, 1e-9);
  }
}

TEST(SimulatedDevice, AFaintForceThatLastsSetsTheHandPushingToo) {
  for (const double force_N : {0.5e-3, 2e-3, 5e-3}) {
    DeviceSettings d = bare();
    d.hand.push_N = 2.0;
    d.hand.push_direction = -Vector3d::UnitZ();
    Rig rig(d);
    rig.run(90, force(force_N, 0, 0));
    EXPECT_FALSE(rig.state().pushing);
    rig.run(91);  // it lets go
    rig.run(91 + 99, force(force_N, 0, 0));
    EXPECT_FALSE(rig.state().pushing);
    rig.run(91 + 300, force(force_N, 0, 0));
    EXPECT_EQ(rig.state().pushing, force_N > 1e-3) << force_N;
  }
}

TEST(SimulatedDevice, AtHalfOfTheRampItPushesHalf) {
  DeviceSettings d = bare();
  d.hand.push_N = 2.0;
  d.hand.push_ramp_s = 0.1;
  Rig rig(d);
  rig.run(49, force(0.02, 0, 0));
  const double before = rig.state().velocity_m_per_s.z();
  rig.run(51);
  EXPECT_NEAR(rig.state().velocity_m_per_s.z() - before, -1.0 / 0.05 * 2e-3, 1e-9);
}

TEST(SimulatedDevice, ARampOfNoTimeIsAllOfThePushAtOnce) {
  DeviceSettings d = bare();
  d.hand.push_N = 2.0;
  d.hand.push_ramp_s = 0.0;
  Rig rig(d);
  rig.run(0, force(0.02, 0, 0));
  rig.run(1);
  EXPECT_NEAR(rig.state().velocity_m_per_s.z(), -2.0 / 0.05 * 1e-3, 1e-12);
}

TEST(SimulatedDevice, BeforeALateTickTheForceActsLonger) {
  DeviceSettings d = bare();
  d.late = {{9, 1.0}, {5, 2e-3}, {2, 4e-3}};
  Rig rig(d);
  rig.run(8, force(0.1, 0, 0));
  EXPECT_NEAR(rig.state().velocity_m_per_s.x(), 0.1 / 0.05 * 14e-3, 1e-12);
  EXPECT_NEAR(rig.state().position.x(), 0.5 * 0.1 / 0.05 * 14e-3 * 14e-3, 1e-12);
}

TEST(SimulatedDevice, ALateTickIsNoneForTheTrajectory) {
  // Coupled by a stiff damper alone, so that its speed is that of the hand's end.
  DeviceSettings d = bare();
  d.hand.damping_N_s_per_m = 100.0;
  d.late = {{20, 9e-3}};
  TimedPose end;
  end.time_s = 1.0;
  end.world_from_tool.position = Vector3d(50e-3, 0, 0);
  Rig rig(d, {TimedPose{}, end});
  rig.run(19);
  EXPECT_NEAR(rig.state().velocity_m_per_s.x(), 50e-3, 1e-9);
  const double x = rig.state().position.x();
  rig.run(20);
  EXPECT_NEAR(rig.state().velocity_m_per_s.x(), 5e-3, 1e-9) << "as far in ten times the time";
  rig.run(21);
  rig.run(40);
  EXPECT_NEAR(rig.state().position.x(), x + 21 * 50e-6, 1e-9);
}

TEST(SimulatedDevice, InASilenceItGivesNoPoseAndMovesOnUnderTheLastForce) {
  for (const int delay : {0, 1}) {
    DeviceSettings d = bare();
    d.delay_ticks = delay;
    d.silences = {{3, 5}};
    Rig rig(d);
    for (std::uint64_t tick = 0; tick < 9; ++tick) {
      const bool silent = tick >= 3 && tick <= 5;
      EXPECT_EQ(rig.device.pose(tick).has_value(), !silent) << tick;
      if (!silent) rig.device.apply(force(0.1, 0, 0));
    }
    EXPECT_NEAR(rig.state().velocity_m_per_s.x(), 0.1 / 0.05 * 1e-3 * (8 - delay), 1e-12);
  }
}

TEST(SimulatedDevice, AJumpShiftsWhatIsReadAndNotTheHandle) {
  DeviceSettings d = bare();
  d.jumps = {{4, Vector3d(0, 50e-3, 0)}, {6, Vector3d(1e-3, -50e-3, 0)}};
  Rig rig(d);
  for (std::uint64_t tick = 0; tick < 9; ++tick) {
    const Vector3d read = rig.run(tick)->position;
    const Vector3d jumped =
        tick < 4 ? Vector3d::Zero() : (tick < 6 ? Vector3d(0, 50e-3, 0) : Vector3d(1e-3, 0, 0));
    EXPECT_NEAR((read - jumped).norm(), 0.0, 1e-15) << tick;
    EXPECT_EQ(rig.state().position, Vector3d(0, kReference, 0));
  }
}

TEST(SimulatedDevice, TheHandleIsReadAtTheNearestStepOfEachEncoder) {
  const double resolution = 55e-6;
  DeviceSettings d = bare();
  d.resolution_m = resolution;
  d.hand.stiffness_N_per_m = 100.0;
  TimedPose start;
  start.world_from_tool.orientation = about_x(0.3);
  start.world_from_tool.position = Vector3d(1.6 * resolution, -1.4 * resolution, 0) -
                                   start.world_from_tool.direction({0, kReference, 0});
  Rig rig(d, {start});
  const auto pose = rig.run(0);
  const Vector3d handle = pose->point({0, kReference, 0});
  EXPECT_TRUE(handle.isApprox(Vector3d(2, -1, 0) * resolution, 1e-9)) << handle.transpose();
  EXPECT_NEAR(rig.state().position.x(), 1.6 * resolution, 1e-12);
}

TEST(SimulatedDevice, WithoutAnInertiaItHasTheTrajectorysOrientationWhateverTheTorque) {
  DeviceSettings d = bare();
  d.angle_resolution = 0.1;
  d.hand.stiffness_N_per_m = 100.0;
  d.hand.damping_N_s_per_m = 5.0;
  TimedPose end;
  end.time_s = 0.1;
  end.world_from_tool.orientation = about_x(0.8);
  Rig rig(d, {TimedPose{}, end});
  for (std::uint64_t tick = 0; tick < 120; ++tick) {
    const auto pose = rig.run(tick, torque(0.1, 0.2, 0.3));
    const Quaterniond asked =
        rig.trajectory.pose_at(static_cast<double>(tick) * (1.0 / 1000.0)).orientation;
    ASSERT_EQ(pose->orientation.coeffs(), asked.coeffs()) << tick;
  }
}

TEST(SimulatedDevice, ATorqueTurnsItAboutTheHandle) {
  DeviceSettings d = bare_turning();
  Rig rig(d);
  const auto pose = rig.run(20, torque(0.02, 0, 0));
  const double angle = 0.5 * 0.02 / 1e-4 * 0.02 * 0.02;
  EXPECT_TRUE(pose->orientation.isApprox(about_x(angle), 1e-6));
  EXPECT_EQ(rig.state().position, Vector3d(0, kReference, 0));
  EXPECT_NEAR(pose->position.z(), -kReference * std::sin(angle), 1e-6)
      << "the tip swings the other way than the shank";
}

TEST(SimulatedDevice, OnTheHandsTurningSpringItSwingsAsInTheTextbook) {
  DeviceSettings d = bare_turning();
  d.turning_damping_Nm_s_per_rad = 1e-3;
  d.hand.turning_damping_Nm_s_per_rad = 2e-3;
  d.hand.turning_stiffness_Nm_per_rad = 0.3;
  const double inertia = 1e-4, b = 3e-3, k = 0.3, angle = 0.01;
  Rig rig(d);
  const double decay = b / (2 * inertia), w = std::sqrt(k / inertia - decay * decay);
  for (std::uint64_t tick = 0; tick < 200; ++tick) {
    const auto pose = rig.run(tick, torque(0, 0, k * angle));
    const double t = 1e-3 * static_cast<double>(tick);
    const double swung =
        angle * (1 - std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)));
    ASSERT_NEAR(2 * pose->orientation.z(), swung, 2e-4 * angle) << tick;
  }
}

TEST(SimulatedDevice, TheHandTurnsItAlongTheShortWay) {
  DeviceSettings d = bare_turning();
  d.hand.turning_damping_Nm_s_per_rad = 2e-2;
  d.hand.turning_stiffness_Nm_per_rad = 0.5;
  TimedPose start, end;
  start.world_from_tool.orientation = about_x(3.0);
  end.time_s = 0.1;
  end.world_from_tool.orientation = about_x(3.4);
  end.world_from_tool.orientation.coeffs() *= -1.0;  // the same orientation
  Rig rig(d, {start, end});
  double least = 0.0;
  for (std::uint64_t tick = 0; tick < 400; ++tick) {
    rig.run(tick);
    least = std::min(least, rig.state().angular_rad_per_s.x());
  }
  EXPECT_GT(least, -1.0) << "it may swing back, but does not go back the long way";
  EXPECT_LT(rig.state().orientation.angularDistance(about_x(3.4)), 1e-4);
}

TEST(SimulatedDevice, TurnedSteadilyItLagsByWhatTheDevicesDampingTakes) {
  DeviceSettings d = bare_turning();
  d.turning_damping_Nm_s_per_rad = 1e-3;
  d.hand.turning_damping_Nm_s_per_rad = 1e-2;
  d.hand.turning_stiffness_Nm_per_rad = 0.3;
  TimedPose end;
  end.time_s = 1.0;
  end.world_from_tool.orientation = about_x(0.1);
  Rig rig(d, {TimedPose{}, end});
  const auto pose = rig.run(800);
  EXPECT_NEAR(pose->orientation.angularDistance(rig.trajectory.pose_at(0.8).orientation),
              1e-3 * 0.1 / 0.3, 1e-6);
}

TEST(SimulatedDevice, TheHandsDamperLooksAtTheSpeedOfItsTurning) {
  // By the damper alone, with a late tick in which the hand's end turns as far in twice the time.
  DeviceSettings d = bare_turning();
  d.hand.turning_damping_Nm_s_per_rad = 1.0;
  d.late = {{60, 1e-3}};
  TimedPose end;
  end.time_s = 0.1;
  end.world_from_tool.orientation = about_x(0.1);
  Rig rig(d, {TimedPose{}, end});
  rig.run(59);
  EXPECT_NEAR(rig.state().angular_rad_per_s.x(), 1.0, 1e-3);
  rig.run(60);
  EXPECT_NEAR(rig.state().angular_rad_per_s.x(), 0.5, 1e-3);
}

TEST(SimulatedDevice, TurningFrictionHoldsAgainstLessThanItself) {
  DeviceSettings d = bare_turning();
  d.turning_friction_Nm = 1e-3;
  Rig rig(d);
  rig.run(100, torque(0, 0.9e-3, 0));
  EXPECT_EQ(rig.state().angular_rad_per_s, Vector3d::Zero());
  rig.run(101, torque(0, 1.1e-3, 0));
  rig.run(102);
  EXPECT_GT(rig.state().angular_rad_per_s.y(), 0.0);
}

TEST(SimulatedDevice, TheTurnSinceTheStartIsReadAtTheNearestStep) {
  const double step = 1e-3;
  DeviceSettings d = bare_turning();
  d.angle_resolution = step;
  TimedPose start;
  start.world_from_tool.orientation = about_x(1.0);
  Rig rig(d, {start});
  EXPECT_TRUE(rig.run(0)->orientation.isApprox(about_x(1.0), 1e-15)) << "its start is a step";
  // Over 20 ticks: 0.5 a t^2 = 0.0077 rad about x and 0.0026 about y.
  const auto pose = rig.run(21, torque(3.85e-3, 1.3e-3, 0));
  const Quaterniond turn = pose->orientation * about_x(1.0).conjugate();
  EXPECT_NEAR(2 * turn.x(), 8 * step, 1e-12);
  EXPECT_NEAR(2 * turn.y(), 3 * step, 1e-12);
  EXPECT_NEAR(2 * turn.z(), 0.0, 1e-12);
  EXPECT_NEAR(pose->orientation.norm(), 1.0, 1e-15);
  const Quaterniond in_truth = rig.state().orientation * about_x(1.0).conjugate();
  EXPECT_NEAR(2 * in_truth.x(), 7.7 * step, 0.05 * step);
}

TEST(SimulatedDevice, NoMassDampingOrStiffnessMakesItUnstable) {
  for (const double mass : {0.01, 1.0}) {
    for (const double damping : {0.0, 100.0, 1e4}) {
      for (const double stiffness : {0.0, 5000.0, 1e9}) {
        DeviceSettings d = bare_turning();
        d.mass_kg = mass;
        d.inertia_kg_m2 = 1e-3 * mass;
        d.damping_N_s_per_m = damping;
        d.turning_damping_Nm_s_per_rad = 1e-3 * damping;
        d.hand.stiffness_N_per_m = stiffness;
        d.hand.turning_stiffness_Nm_per_rad = 1e-3 * stiffness;
        Rig rig(d);
        rig.run(0, {Vector3d(0.1, 0, 0), Vector3d(1e-4, 0, 0)});
        rig.run(1);
        // The same ratio of force to mass either way: the first tick gives at most this speed.
        const double most = 0.1 / mass * 1e-3 * (1 + 1e-6);
        for (std::uint64_t tick = 2; tick < 1000; ++tick) {
          rig.run(tick);
          ASSERT_LE(rig.state().velocity_m_per_s.norm(), most)
              << mass << " " << damping << " " << stiffness << " tick " << tick;
          ASSERT_LE(rig.state().angular_rad_per_s.norm(), most * 1.001)
              << mass << " " << damping << " " << stiffness << " tick " << tick;
        }
      }
    }
  }
}

/// All of a run in bits, with everything in it that a scene can name.
std::vector<double> eventful_run() {
  DeviceSettings d;
  d.inertia_kg_m2 = 1e-4;
  d.turning_friction_Nm = 1e-4;
  d.angle_resolution = 1e-3;
  d.delay_ticks = 1;
  d.hand.push_N = 1.0;
  d.late = {{40, 16e-3}, {80, 3e-3}};
  d.silences = {{100, 120}};
  d.jumps = {{150, Vector3d(0, 0, 1e-3)}};
  TimedPose end;
  end.time_s = 0.2;
  end.world_from_tool = {Vector3d(1e-3, 0, -3e-3), about_x(0.2)};
  Rig rig(d, {TimedPose{}, end});
  std::vector<double> values;
  values.reserve(4000);
  const std::uint64_t before = test::allocation_count();
  for (std::uint64_t tick = 0; tick < 300; ++tick) {
    const auto pose = rig.device.pose(tick);
    if (!pose) continue;
    const double depth = std::max(0.0, -1e-3 - pose->position.z());
    rig.device.apply({Vector3d(0, 0.1, 900.0 * depth), Vector3d(2.0 * depth, 0, 0)});
    for (const double x : pose->position) values.push_back(x);
    for (const double x : pose->orientation.coeffs()) values.push_back(x);
  }
  EXPECT_EQ(test::allocation_count(), before) << "a tick takes no memory";
  EXPECT_TRUE(rig.state().pushing);
  return values;
}

TEST(SimulatedDevice, RepeatsToTheBitAndTakesNoMemory) {
  const std::vector<double> once = eventful_run(), again = eventful_run();
  ASSERT_EQ(once.size(), 7u * 279u);
  ASSERT_EQ(once.size(), again.size());
  EXPECT_EQ(std::memcmp(once.data(), again.data(), once.size() * sizeof(double)), 0);
}

}  // namespace
}  // namespace sulcus::simulated_device_test
