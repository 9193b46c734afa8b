#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "haptics/device/passivity.hpp"

namespace sulcus::passivity_ways_test {
namespace {

using Eigen::Vector3d;

// What passes the port over whole ways: of a force with a potential and of one without.

constexpr double kPi = 3.14159265358979323846;
constexpr double kTick_s = 1e-3;

enum class Controller { kOff, kOn };

/// A port whose device goes where it is led, in whatever it reads of that: with what it truly got
/// out, from the force that is held and the true way.
struct LedPort {
  PassivitySettings settings{};
  Controller controller = Controller::kOn;
  double resolution_m = 0.0;  // 0: none

  PassivityState state{};
  double given_J = 0.0;         // to the hand, true
  double largest_step_N = 0.0;  // of the controller's own part

  template <class Field>
  Vector3d go(const Vector3d& to_m, const Field& field) {
    if (led) given_J += held_N.dot(to_m - last_m);
    led = true;
    last_m = to_m;
    Vector3d seen_m = to_m;
    if (resolution_m > 0.0) {
      seen_m = resolution_m * ((to_m / resolution_m).array() + 0.5).floor().matrix();
    }
    const Wrench wanted{field(seen_m), Vector3d::Zero()};
    observe_passivity({seen_m, Eigen::Quaterniond::Identity()}, state);
    const Wrench sent =
        controller == Controller::kOn ? control_passivity(wanted, settings, state) : wanted;
    hold_wrench(sent, settings, state);
    const Vector3d own_N = sent.force_N - wanted.force_N;
    largest_step_N = std::max(largest_step_N, (own_N - last_own_N).norm());
    last_own_N = own_N;
    held_N = settings.delayed ? std::exchange(under_way_N, sent.force_N) : sent.force_N;
    return sent.force_N;
  }

  bool led = false;
  Vector3d last_m = Vector3d::Zero(), last_own_N = Vector3d::Zero();
  Vector3d held_N = Vector3d::Zero(), under_way_N = Vector3d::Zero();
};

/// A spring to the origin and a swirl about z, F = -k x + s (z cross x): over a turn of radius r it
/// gives out 2 pi s r^2.
struct Swirl {
  double stiffness_N_per_m = 700.0, swirl_N_per_m = 150.0;
  Vector3d operator()(const Vector3d& x_m) const {
    return -stiffness_N_per_m * x_m + swirl_N_per_m * Vector3d::UnitZ().cross(x_m);
  }
};

/// Out of the origin, where there is no force, to a millimetre, 20 turns, and back.
struct Turns {
  LedPort port{};
  double speed_m_per_s = 0.02;
  double direction = 1.0;  // +1: with the swirl
  Swirl field{};

  static constexpr double kRadius_m = 1e-3;
  static constexpr int kTurns = 20;

  double put_in_J = 0.0, given_in_turns_J = 0.0, given_J = 0.0;
  int steps_a_turn = 0;

  void run() {
    const double step_m = speed_m_per_s * kTick_s;
    const auto out = static_cast<int>(std::ceil(kRadius_m / step_m));
    for (int i = 0; i <= out; ++i) port.go(Vector3d(kRadius_m * i / out, 0, 0), field);
    put_in_J = -port.given_J;
    steps_a_turn = static_cast<int>(std::ceil(2.0 * kPi * kRadius_m / step_m));
    for (int i = 1; i <= kTurns * steps_a_turn; ++i) {
      const double angle = direction * 2.0 * kPi * i / steps_a_turn;
      port.go(kRadius_m * Vector3d(std::cos(angle), std::sin(angle), 0.0), field);
    }
    given_in_turns_J = port.given_J + put_in_J;
    for (int i = out - 1; i >= 0; --i) port.go(Vector3d(kRadius_m * i / out, 0, 0), field);
    given_J = port.given_J;
  }

  /// Of a turn along chords, the force held over each: the swirl's share and what sampling leaks.
  double closed_form_J() const {
    const double angle = 2.0 * kPi / steps_a_turn;
    const double square_m2 = kRadius_m * kRadius_m;
    return steps_a_turn * square_m2 *
           (direction * field.swirl_N_per_m * std::sin(angle) +
            field.stiffness_N_per_m * (1.0 - std::cos(angle)));
  }
};

std::string of(const Turns& turns) {
  return std::to_string(1e3 * turns.speed_m_per_s) + " mm/s, quanta of " +
         std::to_string(1e6 * turns.port.resolution_m) + " um, spring of " +
         std::to_string(turns.port.settings.stiffness_N_per_m) + " N/m, delayed " +
         std::to_string(turns.port.settings.delayed);
}

TEST(PassivityWays, WithoutTheControllerASwirlGivesOutWhatItIsWorthWithEveryTurn) {
  Turns turns{.port = {.controller = Controller::kOff}};
  turns.run();
  EXPECT_NEAR(turns.given_in_turns_J, Turns::kTurns * turns.closed_form_J(),
              1e-9 * turns.given_in_turns_J);
  EXPECT_GT(turns.closed_form_J(), 2.0 * turns.put_in_J) << "more than pressing in has stored";
}

TEST(PassivityWays, WithItNoneIsGivenOutOverWholeWaysAndItIsQuiet) {
  for (const bool delayed : {false, true}) {
    for (const double spring_N_per_m : {0.0, 700.0}) {
      for (const double speed : {0.005, 0.02}) {
        for (const double resolution_m : {0.0, 55e-6}) {
          Turns turns{
              .port = {.settings = {.stiffness_N_per_m = spring_N_per_m, .delayed = delayed},
                       .resolution_m = resolution_m},
              .speed_m_per_s = speed};
          turns.run();
          EXPECT_LE(turns.given_in_turns_J, 0.0) << of(turns);
          EXPECT_LE(turns.given_J, 0.0) << of(turns);
          if (!delayed) {
            EXPECT_LT(turns.port.largest_step_N, 0.02) << of(turns);
          }
        }
      }
    }
  }
}

TEST(PassivityWays, AgainstASwirlThereIsNothingToDampButTheLeak) {
  Turns turns{.direction = -1.0};
  turns.run();
  const double leak_J = Turns::kTurns * turns.steps_a_turn * 0.5 * 700.0 * 0.02e-3 * 0.02e-3;
  EXPECT_LT(turns.given_J, 0.0);
  EXPECT_LE(turns.port.state.dissipated_J, 4.1 * leak_J);
}

/// Pressed into a spring of 700 N/m for a millimetre and let out again.
LedPort pressed(double speed_m_per_s, double resolution_m, double spring_N_per_m) {
  LedPort port{.settings = {.stiffness_N_per_m = spring_N_per_m}, .resolution_m = resolution_m};
  const auto wall = [](const Vector3d& x_m) {
    return Vector3d(-700.0 * std::max(0.0, x_m.x()), 0, 0);
  };
  const auto steps = static_cast<int>(std::lround(1e-3 / (speed_m_per_s * kTick_s)));
  for (int i = -steps / 2; i <= steps; ++i) port.go(Vector3d(1e-3 * i / steps, 0, 0), wall);
  for (int i = steps - 1; i >= -steps / 2; --i) port.go(Vector3d(1e-3 * i / steps, 0, 0), wall);
  return port;
}

TEST(PassivityWays, ASpringIsDampedByNoMoreThanFourTimesWhatSamplingLeaks) {
  constexpr double kStored_J = 0.5 * 700.0 * 1e-3 * 1e-3;
  for (const double spring_N_per_m : {0.0, 700.0}) {
    for (const double speed : {0.002, 0.005, 0.02, 0.05}) {
      const LedPort port = pressed(speed, 0.0, spring_N_per_m);
      const double leak_J = 2.0 * kStored_J * speed * kTick_s / 1e-3;  // both ways, K dx^2 / 2 each
      EXPECT_LE(port.given_J, 0.0) << speed;
      EXPECT_LE(port.state.dissipated_J, 4.0 * leak_J) << speed;
      EXPECT_LE(-port.given_J, 3.0 * leak_J) << speed;
    }
  }
}

TEST(PassivityWays, AJumpIsNoMotionThatGoesOn) {
  const auto wall = [](const Vector3d& x_m) {
    return Vector3d(-700.0 * std::max(0.0, x_m.x()), 0, 0);
  };
  LedPort port;
  for (int i = 0; i <= 40; ++i) port.go(Vector3d(5e-6 * i, 0, 0), wall);
  for (int i = 0; i <= 100; ++i) port.go(Vector3d(3.2e-3 + 5e-6 * i, 0, 0), wall);
  EXPECT_LE(port.largest_step_N, 0.0151);
}

TEST(PassivityWays, SoItIsInQuanta) {
  for (const double speed : {0.002, 0.005, 0.02}) {
    const LedPort port = pressed(speed, 55e-6, 700.0);
    EXPECT_LE(port.state.dissipated_J, 0.1 * 350e-6) << speed;
    EXPECT_LT(port.largest_step_N, 0.02) << speed;
  }
}

}  // namespace
}  // namespace sulcus::passivity_ways_test
