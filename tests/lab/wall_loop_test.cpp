#include "tools/sulcus_lab/stability/wall_loop.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/scene/device_presets.hpp"

namespace sulcus::lab::wall_loop_test {
namespace {

/// An Omni held by a hand of the presets.
WallLoop omni_loop(std::string_view hand, int delay_ticks, double wall_damping) {
  WallLoop loop;
  loop.device = device_preset("omni");
  loop.device.hand = hand_preset(hand);
  loop.device.delay_ticks = delay_ticks;
  loop.wall_damping_N_s_per_m = wall_damping;
  return loop;
}

TEST(WallLoop, TheSpectralLimitOfAMassWithDampingIsTheClosedForm) {
  // Without the hand's spring, without delay and B the characteristic polynomial is of second
  // degree, and stability is lost where its constant term, the product of the roots, reaches 1.
  for (const double rate_hz : {500.0, 1000.0, 4000.0}) {
    WallLoop loop = omni_loop("light", 0, 0.0);
    loop.rate_hz = rate_hz;
    loop.device.hand.stiffness_N_per_m = 0.0;
    const double m = 0.045, b = 2.1, t = 1.0 / rate_hz;
    const double decay = std::exp(-b * t / m);
    const double x_by_v = m / b * (1.0 - decay);
    const double x_by_force = t / b - m / (b * b) * (1.0 - decay);
    const double v_by_force = (1.0 - decay) / b;
    const double limit = (1.0 - decay) / (v_by_force * x_by_v - decay * x_by_force);
    EXPECT_NEAR(spectral_limit(loop), limit, 1e-6 * limit) << rate_hz;
  }
}

TEST(WallLoop, WithoutAWallTheSlowestPoleIsThatOfDeviceAndHand) {
  // Under-damped: it dies away with b / 2m whatever the spring.
  for (const int delay_ticks : {0, 1}) {
    const WallLoop loop = omni_loop("light", delay_ticks, 0.0);
    EXPECT_NEAR(spectral_radius(loop, 0.0), std::exp(-2.1 / (2.0 * 0.045) * 1e-3), 1e-9);
  }
}

TEST(WallLoop, TheSimulatedDeviceIsStableUpToTheSpectralLimit) {
  const WallLoop loops[] = {omni_loop("light", 0, 0.0), omni_loop("light", 1, 20.0),
                            omni_loop("firm", 0, 40.0), omni_loop("firm", 1, 8.0),
                            omni_loop("arm", 1, 0.0)};
  for (const WallLoop& loop : loops) {
    const double limit = spectral_limit(loop);
    EXPECT_NEAR(measured_limit(loop), limit, 0.02 * limit)
        << "m_h " << loop.device.hand.mass_kg << ", delay " << loop.device.delay_ticks << ", B "
        << loop.wall_damping_N_s_per_m;
  }
}

TEST(WallLoop, AtAnotherRateToo) {
  WallLoop loop = omni_loop("light", 1, 0.0);
  loop.rate_hz = 3000.0;  // no whole number of substeps
  const double limit = spectral_limit(loop);
  EXPECT_NEAR(measured_limit(loop), limit, 0.02 * limit);
}

TEST(WallLoop, WhereDampingAndDelayAloneBuzzNoWallIsStable) {
  // 40 N s/m a tick late turns back more than the momentum of 45 g.
  const WallLoop loop = omni_loop("light", 1, 40.0);
  EXPECT_EQ(spectral_limit(loop), 0.0);
  EXPECT_EQ(measured_limit(loop), 0.0);
  EXPECT_GT(spectral_limit(omni_loop("light", 1, 38.0)), 0.0);
}

TEST(WallLoop, WithoutDampingInTheWallTheDelayRuleIsWithinTenPerCentForEveryHand) {
  for (const HandPreset& hand : hand_presets()) {
    for (const int delay_ticks : {0, 1}) {
      const WallLoop loop = omni_loop(hand.name, delay_ticks, 0.0);
      const double limit = spectral_limit(loop);
      EXPECT_NEAR(delay_rule(loop), limit, 0.1 * limit) << hand.name << " " << delay_ticks;
    }
  }
}

TEST(WallLoop, WithDampingInTheWallTheDelayRulePromisesALightHandTooMuch) {
  double last = 1.0;
  for (const double wall_damping : {8.0, 20.0, 40.0}) {
    const WallLoop loop = omni_loop("light", 0, wall_damping);
    const double promised = delay_rule(loop) / spectral_limit(loop);
    EXPECT_GT(promised, last + 0.1) << wall_damping;
    last = promised;
  }
}

}  // namespace
}  // namespace sulcus::lab::wall_loop_test
