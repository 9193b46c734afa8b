#include "haptics/spindle.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace sulcus {
namespace {

const SpindleSettings kMotor{1e-3, 5e-9};
constexpr double kFree = 17000.0;  // rad/s

double run(double speed, double load_Nm, double seconds, double rate_hz) {
  const auto ticks = static_cast<int>(std::lround(seconds * rate_hz));
  for (int i = 0; i < ticks; ++i)
    speed = spindle_speed(kMotor, kFree, speed, load_Nm, 1.0 / rate_hz);
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

TEST(Spindle, OneThatDoesNotTurnStaysSo) {
  EXPECT_EQ(spindle_speed(kMotor, 0.0, 0.0, 0.0, 1e-3), 0.0);
}

}  // namespace
}  // namespace sulcus
