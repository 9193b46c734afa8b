#include "haptics/device/output_limiter.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace sulcus::output_limiter_test {
namespace {

using Eigen::Vector3d;

Wrench force(double x, double y = 0.0, double z = 0.0) { return {Vector3d(x, y, z), {0, 0, 0}}; }

/// An edge and what it sent last.
struct Limiter {
  OutputLimits limits;
  OutputLimiterState state;
  Wrench sent;
  double largest_step_N = 0.0;

  void send(const Wrench& wanted, int ticks = 1, bool answered = true, bool jumped = false) {
    for (int i = 0; i < ticks; ++i) {
      const Vector3d before_N = sent.force_N;
      sent = limit_output(wanted, limits, {.silent = !answered, .jumped = jumped}, state);
      largest_step_N = std::max(largest_step_N, (sent.force_N - before_N).norm());
    }
  }
};

/// One whose ramp is through.
Limiter running() {
  Limiter limiter;
  limiter.send({}, 200);
  return limiter;
}

TEST(OutputLimiter, WhatIsWithinTheLimitsPassesToTheLastBit) {
  Limiter limiter = running();
  const OutputLimiterState before = limiter.state;
  for (int i = 0; i < 100; ++i) {
    const Wrench wanted = force(i % 2 == 0 ? 0.3 : 1e-9 / 3.0, 0.1, -0.013 * i);
    limiter.send(wanted);
    EXPECT_EQ(limiter.sent.force_N, wanted.force_N);
  }
  EXPECT_EQ(limiter.state.clamped_ticks, before.clamped_ticks);
  EXPECT_EQ(limiter.state.ramped_ticks, before.ramped_ticks);
  EXPECT_EQ(limiter.state.step_limited_ticks, before.step_limited_ticks);
  EXPECT_EQ(limiter.state.not_finite_ticks, 0u);
}

TEST(OutputLimiter, FirstContactAt20MmPerSComesThroughWhole) {
  // A device of 55 um resolution on the stiffest coupling, 1.2 N/mm.
  Limiter limiter = running();
  for (int i = 0; i < 100; ++i) {
    const double depth_m = 55e-6 * std::floor(20e-6 * i / 55e-6);
    limiter.send(force(1200.0 * depth_m));
    EXPECT_EQ(limiter.sent.force_N.x(), 1200.0 * depth_m);
  }
}

TEST(OutputLimiter, AForceBeyondTheLimitKeepsItsDirection) {
  for (const double size : {4.0, 1e3, 1e200, 1e308}) {
    Limiter limiter = running();
    limiter.send(force(0.6 * size, 0.0, -0.8 * size), 50);
    EXPECT_NEAR(limiter.sent.force_N.x(), 0.6 * 3.3, 1e-12) << size;
    EXPECT_NEAR(limiter.sent.force_N.z(), -0.8 * 3.3, 1e-12) << size;
    EXPECT_EQ(limiter.state.clamped_ticks, 50u);
  }
}

TEST(OutputLimiter, ADeviceWithoutTorquesGetsNone) {
  Limiter limiter = running();
  limiter.send({Vector3d(1.0, 0, 0), Vector3d(0.05, 0, 0)}, 50);
  EXPECT_EQ(limiter.sent.torque_Nm, Vector3d::Zero().eval());
  EXPECT_EQ(limiter.sent.force_N.x(), 1.0);
  EXPECT_EQ(limiter.state.clamped_ticks, 0u) << "what is not rendered is not clamped";
}

TEST(OutputLimiter, TorquesAreClampedAndStepLimitedByThemselves) {
  Limiter limiter;
  limiter.limits.torque_Nm = 0.1;
  limiter.send({}, 200);
  limiter.send({Vector3d(0.2, 0, 0), Vector3d(0, 5.0, 0)});
  EXPECT_EQ(limiter.sent.force_N.x(), 0.2);
  EXPECT_NEAR(limiter.sent.torque_Nm.y(), limiter.limits.torque_step_Nm, 1e-12);
  limiter.send({Vector3d(0.2, 0, 0), Vector3d(0, 5.0, 0)}, 50);
  EXPECT_NEAR(limiter.sent.torque_Nm.y(), 0.1, 1e-12);
}

TEST(OutputLimiter, TheForceRisesOverATenthOfASecond) {
  Limiter limiter;
  for (int i = 0; i < 150; ++i) {
    limiter.send(force(2.0));
    EXPECT_NEAR(limiter.sent.force_N.x(), 2.0 * std::min(1.0, i / 100.0), 1e-9) << i;
  }
  EXPECT_EQ(limiter.state.ramped_ticks, 100u);
}

TEST(OutputLimiter, ALargeForceAtTheStartDoesNotPassTheRamp) {
  Limiter limiter;
  for (int i = 0; i < 100; ++i) {
    limiter.send(force(1e6));
    EXPECT_LE(limiter.sent.force_N.x(), 3.3 * i / 100.0 + 1e-9) << i;
  }
}

TEST(OutputLimiter, TheRampIsAsLongAtAnotherRate) {
  Limiter limiter;
  limiter.limits.dt_s = 0.25e-3;
  limiter.send(force(2.0), 201);
  EXPECT_NEAR(limiter.sent.force_N.x(), 1.0, 1e-9);
}

TEST(OutputLimiter, WithoutAnAnswerTheForceFallsIn50MsAndThenRisesAgain) {
  Limiter limiter = running();
  limiter.send(force(0.4), 10);
  ASSERT_EQ(limiter.sent.force_N.x(), 0.4);
  limiter.largest_step_N = 0.0;
  limiter.send(force(0.4), 26, false);
  EXPECT_NEAR(limiter.sent.force_N.x(), 0.2, 1e-9) << "half way";
  limiter.send(force(0.4), 25, false);
  EXPECT_NEAR(limiter.sent.force_N.x(), 0.0, 1e-9);
  limiter.send(force(0.4), 500, false);
  EXPECT_NEAR(limiter.sent.force_N.x(), 0.0, 1e-9);
  limiter.send(force(0.4), 51);
  EXPECT_NEAR(limiter.sent.force_N.x(), 0.2, 1e-9) << "half way up";
  EXPECT_LE(limiter.largest_step_N, 0.4 / 50 + 1e-9) << "nothing jumps";
}

TEST(OutputLimiter, OneLostAnswerIsHardlyFelt) {
  Limiter limiter = running();
  limiter.send(force(1.0), 10);
  limiter.largest_step_N = 0.0;
  limiter.send(force(1.0), 1, false);
  limiter.send(force(1.0), 10);
  EXPECT_EQ(limiter.sent.force_N.x(), 1.0);
  EXPECT_LE(limiter.largest_step_N, 0.05 + 1e-9);
}

TEST(OutputLimiter, AfterAJumpOfTheDeviceItStartsAnewWithoutAJumpOfTheForce) {
  Limiter limiter = running();
  limiter.send(force(3.0), 20);
  ASSERT_EQ(limiter.sent.force_N.x(), 3.0);
  limiter.largest_step_N = 0.0;
  limiter.send(force(-3.0), 1, true, true);
  EXPECT_NEAR(limiter.sent.force_N.x(), 2.5, 1e-9);
  limiter.send(force(-3.0), 49);
  EXPECT_NEAR(limiter.sent.force_N.x(), -3.0 * 0.49, 1e-9);
  limiter.send(force(-3.0), 60);
  EXPECT_EQ(limiter.sent.force_N.x(), -3.0);
  EXPECT_LE(limiter.largest_step_N, 0.5 + 1e-9);
}

TEST(OutputLimiter, AStepIsTakenInPartsInWhateverDirection) {
  Limiter limiter = running();
  limiter.send(force(1.2), 20);
  const std::uint64_t before = limiter.state.step_limited_ticks;
  limiter.largest_step_N = 0.0;
  limiter.send(force(0.0, 1.6));  // 2 N off, along (-0.6, 0.8)
  EXPECT_NEAR(limiter.sent.force_N.x(), 1.2 - 0.3, 1e-12);
  EXPECT_NEAR(limiter.sent.force_N.y(), 0.4, 1e-12);
  limiter.send(force(0.0, 1.6), 4);
  EXPECT_EQ(limiter.sent.force_N, Vector3d(0.0, 1.6, 0.0)) << "it gets there, to the last bit";
  EXPECT_LE(limiter.largest_step_N, 0.5 + 1e-12);
  EXPECT_GE(limiter.state.step_limited_ticks - before, 3u);
  EXPECT_LE(limiter.state.step_limited_ticks - before, 4u)
      << "the last may be whole but for rounding";
}

TEST(OutputLimiter, WhateverIsWantedWhatIsSentIsWithinAllLimits) {
  // A linear congruence, so that the wrenches are the same on every machine.
  std::uint32_t seed = 1;
  const auto next = [&] {
    seed = seed * 1664525u + 1013904223u;
    return static_cast<double>(seed >> 8) / (1 << 23) - 1.0;
  };
  Limiter limiter;
  limiter.limits.torque_Nm = 0.1;
  for (int i = 0; i < 20000; ++i) {
    const double size = i % 7 == 0 ? 1e5 : 2.0;
    const Wrench wanted{size * Vector3d(next(), next(), next()), Vector3d(next(), next(), next())};
    const Wrench before = limiter.sent;
    limiter.send(wanted, 1, i % 500 > 20, i % 1700 == 0);
    ASSERT_LE(limiter.sent.force_N.norm(), 3.3 * (1 + 1e-12));
    ASSERT_LE(limiter.sent.torque_Nm.norm(), 0.1 * (1 + 1e-12));
    ASSERT_LE((limiter.sent.force_N - before.force_N).norm(), 0.5 * (1 + 1e-12));
    ASSERT_LE((limiter.sent.torque_Nm - before.torque_Nm).norm(), 0.02 * (1 + 1e-12));
  }
}

}  // namespace
}  // namespace sulcus::output_limiter_test
