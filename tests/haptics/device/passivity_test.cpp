#include "haptics/device/passivity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

namespace sulcus::passivity_test {
namespace {

using Eigen::Vector3d;

Pose at(double x_m) { return {Vector3d(x_m, 0, 0), Eigen::Quaterniond::Identity()}; }
Wrench force(double x_N) { return {Vector3d(x_N, 0, 0), Vector3d::Zero()}; }

enum class Controller { kOff, kOn };

/// A free mass without damping thrown along +x at a spring wall at 0, under a device's tick.
struct Taps {
  double stiffness_N_per_m = 600.0;
  double speed_m_per_s = 0.05;
  double resolution_m = 55e-6;  // 0: none
  bool delayed = false;
  Controller controller = Controller::kOn;

  double largest_pull_N = 0.0;
  double largest_force_N = 0.0;
  PassivityState state{};

  static constexpr double kMass_kg = 0.045;
  static constexpr int kSubsteps = 40;  // of 25 us

  /// Of the true kinetic energy after the tap to that before it. `offset_m` sets where in a quantum
  /// and in a tick it meets the wall.
  double tap(double offset_m) {
    const PassivitySettings settings{.delayed = delayed};
    constexpr double kStart_m = -1e-3;
    double x_m = kStart_m - offset_m, v = speed_m_per_s, on_way_N = 0.0;
    for (int tick = 0; tick < 1000 && !(v < 0.0 && x_m < kStart_m); ++tick) {
      const double seen_m =
          resolution_m > 0.0 ? resolution_m * std::round(x_m / resolution_m) : x_m;
      const Wrench wanted = force(-stiffness_N_per_m * std::max(0.0, seen_m));
      observe_passivity(at(seen_m), state);
      const Wrench sent =
          controller == Controller::kOn ? control_passivity(wanted, settings, state) : wanted;
      hold_wrench(sent, settings, state);
      largest_pull_N = std::max(largest_pull_N, sent.force_N.x());
      largest_force_N = std::max(largest_force_N, sent.force_N.norm());
      const double force_N = delayed ? std::exchange(on_way_N, sent.force_N.x()) : sent.force_N.x();
      for (int i = 0; i < kSubsteps; ++i) {
        v += force_N / kMass_kg * (1e-3 / kSubsteps);
        x_m += v * (1e-3 / kSubsteps);
      }
    }
    return v * v / (speed_m_per_s * speed_m_per_s);
  }

  /// The most and the mean of 100, each from another place.
  struct Ratio {
    double most = 0.0, mean = 0.0;
  };
  Ratio hundred() {
    Ratio ratio;
    for (int i = 0; i < 100; ++i) {
      const double kept = tap(10e-6 * i);
      ratio.most = std::max(ratio.most, kept);
      ratio.mean += kept / 100;
    }
    return ratio;
  }
};

TEST(Passivity, EnergyIsTheHeldForceTimesTheWay) {
  PassivityState state;
  observe_passivity(at(1.0), state);
  EXPECT_EQ(state.energy_J, 0.0) << "the first pose has come from nowhere";
  EXPECT_EQ(state.moved.linear_m_per_s, Vector3d::Zero().eval());
  hold_wrench(force(-2.0), {}, state);
  observe_passivity(at(1.003), state);
  EXPECT_NEAR(state.energy_J, 2.0 * 3e-3, 1e-12);
  hold_wrench(force(-1.0), {}, state);
  observe_passivity(at(0.998), state);
  EXPECT_NEAR(state.energy_J, 2.0 * 3e-3 - 1.0 * 5e-3, 1e-12);
}

TEST(Passivity, ATorqueWorksOverTheTurn) {
  PassivityState state;
  observe_passivity(at(0.0), state);
  hold_wrench({Vector3d::Zero(), Vector3d(0, 0, 0.2)}, {}, state);
  observe_passivity(
      {Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(1e-3, Vector3d::UnitZ()))}, state);
  EXPECT_NEAR(state.energy_J, -0.2e-3, 1e-9);
}

TEST(Passivity, WithADelayTheForceOfTheTickBeforeWorks) {
  const PassivitySettings settings{.delayed = true};
  PassivityState state;
  observe_passivity(at(0.0), state);
  hold_wrench(force(-1.0), settings, state);
  observe_passivity(at(1e-3), state);
  EXPECT_EQ(state.energy_J, 0.0);
  hold_wrench(force(-5.0), settings, state);
  observe_passivity(at(2e-3), state);
  EXPECT_NEAR(state.energy_J, 1e-3, 1e-12);
}

TEST(Passivity, WhatAContactDissipatedDoesNotHideWhatTheNextOneGives) {
  PassivityState state;
  const auto step = [&](double x_m, double force_N) {
    observe_passivity(at(x_m), state);
    hold_wrench(force(force_N), {}, state);
  };
  step(0.0, -1.0);
  step(0.1, 0.0);  // dissipated 0.1 J, as cutting does
  EXPECT_NEAR(state.energy_J, 0.1, 1e-12);
  step(0.2, 1.0);  // another contact
  step(0.21, 1.0);
  step(0.22, 0.0);  // gave 0.02 J
  EXPECT_NEAR(state.energy_J, -0.02, 1e-12);
  EXPECT_NEAR(state.least_J, -0.02, 1e-12);
  EXPECT_NEAR(state.given_out_J(), 0.02, 1e-12);
  step(0.3, 1.0);  // a third one
  step(0.305, 0.0);
  EXPECT_NEAR(state.energy_J, -0.005, 1e-12);
  EXPECT_NEAR(state.least_J, -0.02, 1e-12) << "of the run";
  EXPECT_NEAR(state.given_out_J(), 0.025, 1e-12) << "over the contacts";
}

TEST(Passivity, WithoutQuantaTheObserverSeesWhatATapGained) {
  Taps taps{.resolution_m = 0.0, .controller = Controller::kOff};
  const double gained = taps.tap(3e-6) - 1.0;
  EXPECT_GT(gained, 0.05);
  const double kinetic_J = 0.5 * Taps::kMass_kg * 0.05 * 0.05;
  // The last force is held past the wall: within the substep's part of it.
  EXPECT_NEAR(-taps.state.least_J, gained * kinetic_J, 0.01 * kinetic_J);
}

TEST(Passivity, WithoutTheControllerTapsGain) {
  for (const double stiffness : {600.0, 900.0, 1200.0}) {
    Taps taps{.stiffness_N_per_m = stiffness, .controller = Controller::kOff};
    EXPECT_GT(taps.hundred().mean, 1.15) << stiffness;
    EXPECT_GT(taps.state.given_out_J(), 0.0);
    EXPECT_EQ(taps.state.damped_ticks, 0u);
  }
}

TEST(Passivity, WithItNoneOf100TapsGainsMoreThan2Percent) {
  for (const bool delayed : {false, true}) {
    for (double stiffness = 600.0; stiffness <= 1200.0; stiffness += 50.0) {
      Taps taps{.stiffness_N_per_m = stiffness, .delayed = delayed};
      const Taps::Ratio kept = taps.hundred();
      EXPECT_LE(kept.most, 1.02) << stiffness << " N/m, delayed " << delayed;
      EXPECT_GE(kept.mean, 0.7) << "and it is not a swamp: " << stiffness;
      EXPECT_GT(taps.state.damped_ticks, 0u);
      EXPECT_GT(taps.state.dissipated_J, 0.0);
    }
  }
}

TEST(Passivity, ItNeitherPullsNorExceedsTheLimit) {
  Taps slow{.stiffness_N_per_m = 1200.0};
  slow.hundred();
  EXPECT_LE(slow.largest_pull_N, 0.0);
  Taps fast{.stiffness_N_per_m = 1200.0, .speed_m_per_s = 0.4};
  fast.tap(0.0);
  const double deepest_N = 1200.0 * 0.4 * std::sqrt(Taps::kMass_kg / 1200.0);
  EXPECT_LE(fast.largest_force_N, std::max(3.3, 1.1 * deepest_N));
  EXPECT_LE(fast.largest_pull_N, 0.0);
}

/// A tick under a wall: what is asked for where the tool has come to.
Wrench under(double x_m, const Wrench& wanted, PassivityState& state,
             const PassivitySettings& settings = {}) {
  observe_passivity(at(x_m), state);
  const Wrench asked = control_passivity(wanted, settings, state);
  hold_wrench(asked, settings, state);
  return asked;
}

TEST(Passivity, TheDampingStopsAtTheLimitOfTheForce) {
  const PassivitySettings settings{.limit_N = 1.0};
  PassivityState state;
  under(0.0, force(0.0), state, settings);
  EXPECT_NEAR(under(100e-6, force(-0.995), state, settings).force_N.x(), -1.0, 1e-12);
  // One that is beyond it already is not made larger.
  state = {};
  under(0.0, force(0.0), state, settings);
  EXPECT_NEAR(under(100e-6, force(-1.5), state, settings).force_N.x(), -1.5, 1e-12);
}

TEST(Passivity, TheDampingConstantIsBounded) {
  // By four times that of what a wall leaks, K T / 2, however much there is to be taken back.
  constexpr double kStiffness = 1000.0, kStep_m = 20e-6;
  PassivityState state;
  under(0.0, force(0.0), state);
  state.energy_J = -1.0;
  for (int i = 1; i < 50; ++i) {
    const double wall_N = -kStiffness * kStep_m * i;
    const double own_N = under(kStep_m * i, force(wall_N), state).force_N.x() - wall_N;
    state.energy_J = std::min(state.energy_J, -1.0);
    EXPECT_LE(-own_N, 4.0 * 0.5 * kStiffness * kStep_m * (1.0 + 1e-12)) << i;
    if (i > 20) {
      EXPECT_GE(-own_N, 1.9 * kStiffness * kStep_m) << "all of it";
    }
  }
}

TEST(Passivity, InAirAndAtRestThereIsNoDamping) {
  PassivityState state;
  for (int i = 0; i < 10; ++i) under(1e-4 * i, force(-1.0 * i), state);
  ASSERT_GT(state.damped_ticks, 0u);
  const std::uint64_t before = state.damped_ticks;
  EXPECT_EQ(under(1e-4 * 9, force(-4.0), state).force_N.x(), -4.0) << "at rest";
  EXPECT_EQ(under(8e-4, force(0.0), state).force_N.x(), 0.0) << "in air";
  EXPECT_EQ(state.damped_ticks, before);
}

TEST(Passivity, WhatAContactLeftUnpaidIsNotTakenFromTheNext) {
  PassivityState state;
  under(0.0, force(0.0), state);
  under(0.0, force(-1.0), state);
  under(-1e-3, force(0.0), state);  // it gave 1 mJ, and is gone
  EXPECT_NEAR(state.energy_J, -1e-3, 1e-12);
  under(-1e-3, force(0.0), state);
  const double force_N = under(-0.99e-3, force(-0.01), state).force_N.x();
  EXPECT_GE(force_N, -0.03) << "half a tick's rise and one ahead, with their margin, are 0.011 N";
}

TEST(Passivity, AConstantForceIsLeftAloneUntilItHasGivenBackWhatItTook) {
  // It leaks nothing, wherever it moves.
  PassivityState state;
  double x_m = 0.0;
  const auto go = [&](double to_m) {
    const double way_m = to_m - x_m;
    const auto steps = static_cast<int>(std::lround(std::abs(way_m) / 20e-6));
    double least_N = HUGE_VAL;
    for (int i = 1; i <= steps; ++i) {
      const double now_m = x_m + way_m * i / steps;
      least_N = std::min(least_N, -under(now_m, force(-1.0), state).force_N.x());
    }
    x_m = to_m;
    return least_N;
  };
  for (const double to_m : {3e-3, 1e-3, 2e-3, 1e-3, 3e-3, 1e-3}) EXPECT_EQ(go(to_m), 1.0);
  EXPECT_LT(go(-3e-3), 1e-3);
  EXPECT_GE(state.energy_J, -0.015 * 20e-6) << "but for a step of the damping, in a tick";
}

TEST(Passivity, WhatTheEdgeHeldBackIsNotTheContactsDebt) {
  // Deep in a wall under an edge that sends a tenth: pushing in, it absorbs far less than a wall
  // would; nothing is to be taken back for that.
  PassivityState state;
  double damping_N = 0.0;
  for (int i = 0; i < 50; ++i) {
    const Wrench wanted = force(-1.0 - 1e-3 * i);
    observe_passivity(at(1e-4 * i), state);
    damping_N = std::max(
        damping_N, std::abs(control_passivity(wanted, {}, state).force_N.x() - wanted.force_N.x()));
    hold_wrench(force(0.1 * wanted.force_N.x()), {}, state);
  }
  // The leak of one tick is half the rise of the force.
  EXPECT_LE(damping_N, 3e-3);
}

TEST(Passivity, ATorqueThatIsNotRenderedDoesNotCount) {
  // A constant force beside a torque that changes with the turn.
  PassivityState with, without;
  for (int i = 0; i < 20; ++i) {
    const Pose pose{Vector3d(1e-4 * i, 0, 0),
                    Eigen::Quaterniond(Eigen::AngleAxisd(1e-2 * i, Vector3d::UnitZ()))};
    const Wrench wanted{Vector3d(-1, 0, 0), Vector3d(0, 0, -0.05 * i)};
    const PassivitySettings rendered{.renders_torque = true};
    observe_passivity(pose, with);
    hold_wrench(control_passivity(wanted, rendered, with), rendered, with);
    observe_passivity(pose, without);
    hold_wrench({control_passivity(wanted, {}, without).force_N, Vector3d::Zero()}, {}, without);
  }
  EXPECT_EQ(without.damped_ticks, 0u);
  EXPECT_GT(with.damped_ticks, 0u);
}

}  // namespace
}  // namespace sulcus::passivity_test
