#include "haptics/spindle.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace sulcus::spindle_test {
namespace {

const SpindleSettings kMotor{1e-3, 5e-9, 1.0, {}};
constexpr double kFree = 17000.0;  // rad/s

double run(double speed, double load_Nm, double seconds, double rate_hz,
           const SpindleSettings& motor = kMotor) {
  const auto ticks = static_cast<int>(std::lround(seconds * rate_hz));
  for (int i = 0; i < ticks; ++i)
    speed = spindle_speed(motor, kFree, speed, load_Nm, 1.0 / rate_hz);
  return speed;
}

TEST(Spindle, WithoutLoadItKeepsItsSpeed) { EXPECT_NEAR(run(kFree, 0.0, 1.0, 1000), kFree, 1e-6); }

TEST(Spindle, UnderALoadItSettlesWhereTheMotorHoldsIt) {
  EXPECT_NEAR(run(kFree, 0.4e-3, 2.0, 1000), 0.6 * kFree, 1e-3 * kFree);
}

TEST(Spindle, ItRecoversWithItsTimeConstant) {
  const double time_s = kMotor.inertia_kg_m2 * kFree / kMotor.stall_torque_Nm;
  const double gone = 1.0 - run(0.0, 0.0, time_s, 10000) / kFree;
  EXPECT_NEAR(gone, std::exp(-1.0), 0.01);
}

TEST(Spindle, BeyondItsStallTorqueItStandsAndDoesNotTurnBack) {
  EXPECT_EQ(run(kFree, 2e-3, 2.0, 1000), 0.0);
}

TEST(Spindle, NoRateMakesItUnstable) {
  for (const double rate_hz : {10.0, 100.0, 500.0, 20000.0}) {
    EXPECT_NEAR(run(kFree, 0.4e-3, 5.0, rate_hz), 0.6 * kFree, 1e-3 * kFree) << rate_hz;
  }
}

/// Holds its speed within 2 % as long as 20 W and 2 mN m are enough.
SpindleSettings held_motor() {
  SpindleSettings motor;
  motor.stall_torque_Nm = 2e-3;
  motor.droop = 0.02;
  motor.power_W = 20.0;
  return motor;
}

TEST(Spindle, WithLittleDroopItHoldsItsSpeedUpToItsPower) {
  for (const double load_Nm : {0.2e-3, 0.6e-3, 1.1e-3}) {
    ASSERT_LT(load_Nm * kFree, *held_motor().power_W);
    EXPECT_NEAR(run(kFree, load_Nm, 2.0, 1000, held_motor()),
                kFree * (1.0 - held_motor().droop * load_Nm / held_motor().stall_torque_Nm),
                1e-6 * kFree);
  }
}

TEST(Spindle, BeyondItsPowerItGoesAsFastAsThatAllows) {
  for (const double rate_hz : {100.0, 1000.0, 20000.0}) {
    for (const double load_Nm : {1.4e-3, 1.9e-3}) {
      EXPECT_NEAR(run(kFree, load_Nm, 5.0, rate_hz, held_motor()), *held_motor().power_W / load_Nm,
                  1e-3 * kFree)
          << rate_hz;
    }
  }
  EXPECT_EQ(run(kFree, 2.1e-3, 5.0, 1000, held_motor()), 0.0) << "beyond its torque";
}

TEST(Spindle, ItRunsUpWithNoMoreThanItsTorqueAndItsPower) {
  const SpindleSettings motor = held_motor();
  constexpr double kStep_s = 1e-5;
  double speed = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double after = spindle_speed(motor, kFree, speed, 0.0, kStep_s);
    const double torque_Nm = motor.inertia_kg_m2 * (after - speed) / kStep_s;
    ASSERT_LE(torque_Nm, motor.stall_torque_Nm * (1.0 + 1e-9));
    ASSERT_LE(torque_Nm * after, *motor.power_W * (1.0 + 1e-9));
    speed = after;
  }
  EXPECT_NEAR(speed, kFree, 1e-3 * kFree);
}

TEST(Spindle, OneThatDoesNotTurnStaysSo) {
  EXPECT_EQ(spindle_speed(kMotor, 0.0, 0.0, 0.0, 1e-3), 0.0);
}

}  // namespace
}  // namespace sulcus::spindle_test
