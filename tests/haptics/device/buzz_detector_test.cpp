#include "haptics/device/buzz_detector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::buzz_detector_test {
namespace {

using Eigen::Vector3d;

constexpr double kTick_s = 1e-3;
constexpr double kResolution_m = 55e-6;

/// A device (45 g, 0.1 N s/m, Coulomb friction of 0.05 N) in a light hand (100 N/m, 2 N s/m) comes
/// at 20 mm/s to a spring wall at 0 and is then pushed with up to 1 N, over 0.1 s: a push all at
/// once makes an impact of its own.
struct Loop {
  double stiffness_N_per_m;
  int delay_ticks = 0;

  struct Run {
    std::vector<double> force_N, x_m;
    int contact = -1;  // first tick with force
  };

  Run run(int ticks = 2000) const {
    constexpr double kMass_kg = 0.045, kDamping = 0.1, kFriction_N = 0.05;
    constexpr double kHandStiffness = 100.0, kHandDamping = 2.0, kApproach = 0.02;
    constexpr double kPush_N = 1.0, kPushed_s = 0.1;
    constexpr int kSubsteps = 40;
    constexpr double kStep_s = kTick_s / kSubsteps;
    Run run;
    double x_m = -1e-3, v = kApproach, hand_m = x_m, on_way_N = 0.0;
    for (int tick = 0; tick < ticks; ++tick) {
      const double seen_m = kResolution_m * std::round(x_m / kResolution_m);
      const double force_N = stiffness_N_per_m * std::max(0.0, seen_m);
      if (run.contact < 0 && force_N > 0.0) run.contact = tick;
      run.force_N.push_back(force_N);
      run.x_m.push_back(x_m);
      const double held_N = delay_ticks > 0 ? std::exchange(on_way_N, force_N) : force_N;
      const bool touches = run.contact >= 0;
      const double hand_v = touches ? 0.0 : kApproach;
      const double push_N =
          touches ? kPush_N * std::min(1.0, (tick - run.contact) * kTick_s / kPushed_s) : 0.0;
      for (int i = 0; i < kSubsteps; ++i) {
        hand_m += hand_v * kStep_s;
        const double sum_N = push_N + kHandStiffness * (hand_m - x_m) +
                             kHandDamping * (hand_v - v) - kDamping * v - held_N;
        v += sum_N / kMass_kg * kStep_s;
        const double held_back = kFriction_N / kMass_kg * kStep_s;
        v = std::copysign(std::max(0.0, std::abs(v) - held_back), v);
        x_m += v * kStep_s;
      }
    }
    return run;
  }

  /// RMS of the place over the last 0.6 s under one resolution.
  bool stable() const {
    const Run all = run();
    const std::vector<double> x_m(all.x_m.end() - 600, all.x_m.end());
    double mean = 0.0, square = 0.0;
    for (const double x : x_m) mean += x / 600;
    for (const double x : x_m) square += (x - mean) * (x - mean) / 600;
    return std::sqrt(square) < kResolution_m;
  }

  double threshold_N() const { return buzz_threshold_N(stiffness_N_per_m, kResolution_m); }
};

/// Stepped upward, the last stable one before six in a row, 12 %, that are not: where it ends,
/// quanta and friction make it patchy.
double largest_stable(int delay_ticks) {
  double largest = 0.0;
  int failed = 0;
  for (double stiffness = 500.0; failed < 6; stiffness *= 1.02) {
    const bool stable = Loop{stiffness, delay_ticks}.stable();
    failed = stable ? 0 : failed + 1;
    if (stable) largest = stiffness;
  }
  return largest;
}

/// Ticks on which it speaks of a force along a direction.
std::vector<int> spoken(const std::vector<double>& force_N, double threshold_N,
                        const Vector3d& along = Vector3d::UnitZ(), double dt_s = kTick_s) {
  BuzzState state;
  std::vector<int> ticks;
  for (int tick = 0; tick < static_cast<int>(force_N.size()); ++tick) {
    if (buzz(force_N[static_cast<std::size_t>(tick)] * along, threshold_N, dt_s, state)) {
      ticks.push_back(tick);
    }
  }
  return ticks;
}

/// The tick on which a force has first fallen by `by_N` from the most it was.
int first_fall(const std::vector<double>& force_N, double by_N) {
  double most_N = 0.0;
  for (std::size_t i = 0; i < force_N.size(); ++i) {
    most_N = std::max(most_N, force_N[i]);
    if (force_N[i] < most_N - by_N) return static_cast<int>(i);
  }
  return -1;
}

TEST(BuzzDetector, BelowTheLargestStableStiffnessItNeverSpeaks) {
  for (const int delay : {0, 1}) {
    const double largest = largest_stable(delay);
    for (double part = 0.5; part <= 0.8; part += 0.02) {
      const Loop loop{part * largest, delay};
      EXPECT_TRUE(loop.stable());
      EXPECT_TRUE(spoken(loop.run().force_N, loop.threshold_N()).empty())
          << loop.stiffness_N_per_m << " N/m, delay " << delay;
    }
  }
}

TEST(BuzzDetector, AboveItItSpeaksWithin50MsOfTheFirstReversal) {
  for (const int delay : {0, 1}) {
    const double largest = largest_stable(delay);
    for (const double part : {1.1, 1.5}) {
      const Loop loop{part * largest, delay};
      ASSERT_FALSE(loop.stable()) << part << " of " << largest;
      const std::vector<double> force_N = loop.run().force_N;
      const std::vector<int> ticks = spoken(force_N, loop.threshold_N());
      ASSERT_FALSE(ticks.empty()) << part << " delay " << delay;
      EXPECT_LE(ticks.front() - first_fall(force_N, loop.threshold_N()), 50)
          << part << " delay " << delay;
    }
  }
}

TEST(BuzzDetector, OnAReachedLimitCycleItKeepsSpeaking) {
  const Loop loop{1.2 * largest_stable(0), 0};
  const std::vector<int> ticks = spoken(loop.run().force_N, loop.threshold_N());
  EXPECT_GT(std::ranges::count_if(ticks, [](int tick) { return tick >= 1000; }), 500)
      << "most of the time: the quanta make swings uneven";
}

TEST(BuzzDetector, FirstContactIsNotABuzz) {
  std::vector<double> force_N(100, 0.0);
  for (int i = 0; i < 400; ++i) force_N.push_back(std::min(1.0, 0.02 * i));
  EXPECT_TRUE(spoken(force_N, 0.05).empty());
}

/// An impact and bounces, half sines, each with `kept` of the force of the one before.
std::vector<double> bounces(int count, int touch_ticks, int air_ticks, double kept) {
  std::vector<double> force_N(20, 0.0);
  double size_N = 3.0;
  for (int i = 0; i < count; ++i, size_N *= kept) {
    for (int t = 0; t < touch_ticks; ++t) {
      force_N.push_back(size_N * std::sin(M_PI * (t + 0.5) / touch_ticks));
    }
    force_N.insert(force_N.end(), static_cast<std::size_t>(air_ticks), 0.0);
  }
  force_N.insert(force_N.end(), 200, 0.0);
  return force_N;
}

TEST(BuzzDetector, AnImpactWithBouncesIsNotABuzz) {
  for (const int count : {1, 2, 3, 4}) {
    for (const int touch_ticks : {3, 6, 12}) {
      for (const int air_ticks : {1, 5, 15}) {
        for (const double kept : {0.3, 0.6, 0.9}) {
          EXPECT_TRUE(spoken(bounces(count, touch_ticks, air_ticks, kept), 0.05).empty())
              << count << " " << touch_ticks << " " << air_ticks << " " << kept;
        }
      }
    }
  }
}

TEST(BuzzDetector, BouncesThatDoNotDieAwayAreOne) {
  EXPECT_FALSE(spoken(bounces(3, 6, 5, 1.0), 0.05).empty());
}

TEST(BuzzDetector, SlidingOverARoughMolarIsNotABuzz) {
  // 10 mm/s over voxels of 34.8 um: 0.06 N up and down, 287 times a second, on a force that rises
  // and falls with the crown; a coupling of 700 N/m.
  std::vector<double> force_N;
  for (int tick = 0; tick < 5000; ++tick) {
    const double place_m = 10e-3 * tick * kTick_s;
    const double crown_N = 0.8 + 0.5 * std::sin(2.0 * M_PI * place_m / 4e-3);
    const double grid = place_m / 34.8e-6;
    force_N.push_back(crown_N + 0.06 * (grid - std::floor(grid)));
  }
  EXPECT_TRUE(spoken(force_N, buzz_threshold_N(700.0, kResolution_m)).empty());
}

std::vector<double> wave(double hz, double half_swing_N, int ticks, double dt_s = kTick_s) {
  std::vector<double> force_N;
  force_N.reserve(static_cast<std::size_t>(ticks));
  for (int i = 0; i < ticks; ++i) {
    force_N.push_back(1.0 + half_swing_N * std::sin(2.0 * M_PI * hz * i * dt_s));
  }
  return force_N;
}

TEST(BuzzDetector, ItHearsFrom23To250HzAndNotBelow20) {
  for (const double hz : {23.0, 35.0, 60.0, 100.0, 160.0, 250.0}) {
    EXPECT_FALSE(spoken(wave(hz, 0.2, 1000), 0.1).empty()) << hz;
  }
  for (const double hz : {1.0, 5.0, 10.0, 20.0}) {
    EXPECT_TRUE(spoken(wave(hz, 0.2, 1000), 0.1).empty()) << hz;
  }
}

TEST(BuzzDetector, ASlowOneIsHeardTheSecondTimeItComesBack) {
  // As slowly as a heavy arm swings, from rest on.
  for (const double hz : {23.0, 24.0, 27.0, 35.0}) {
    const std::vector<double> force_N = wave(hz, 0.6, 1000);
    const std::vector<int> ticks = spoken(force_N, 0.1);
    ASSERT_FALSE(ticks.empty()) << hz;
    EXPECT_LE(ticks.front() - first_fall(force_N, 0.1), 50) << hz;
  }
}

TEST(BuzzDetector, ASwingThatDiesAwayIsNone) {
  // Each way 0.93 of the last; quanta round it to 0.05 N.
  for (const double hz : {23.0, 35.0, 60.0, 120.0}) {
    for (const double quantum_N : {1e-6, 0.05}) {
      std::vector<double> force_N(50, 3.0);
      for (int i = 0; i < 1000; ++i) {
        const double halves = 2.0 * hz * i * kTick_s;
        const double swing_N = 3.0 * std::pow(0.93, halves) * std::sin(M_PI * halves);
        force_N.push_back(quantum_N * std::round((3.0 + swing_N) / quantum_N));
      }
      // As far down as its quanta do not make two ways alike.
      force_N.resize(50 + static_cast<std::size_t>(12.0 / (2.0 * hz * kTick_s)));
      EXPECT_TRUE(spoken(force_N, 0.1).empty()) << hz << " Hz, " << quantum_N << " N";
    }
  }
}

TEST(BuzzDetector, TheWindowIsATimeNotANumberOfTicks) {
  for (const double dt_s : {2e-3, 1e-3, 0.25e-3}) {
    const auto ticks = static_cast<int>(std::lround(1.0 / dt_s));
    EXPECT_FALSE(spoken(wave(50.0, 0.2, ticks, dt_s), 0.1, Vector3d::UnitX(), dt_s).empty());
    EXPECT_TRUE(spoken(wave(15.0, 0.2, ticks, dt_s), 0.1, Vector3d::UnitX(), dt_s).empty());
  }
}

TEST(BuzzDetector, SwingsUnderTheThresholdDoNotCount) {
  EXPECT_TRUE(spoken(wave(100.0, 0.049, 1000), 0.1).empty());
  EXPECT_FALSE(spoken(wave(100.0, 0.06, 1000), 0.1).empty());
}

TEST(BuzzDetector, AFallAfterARiseUnderTheThresholdIsNoReversal) {
  BuzzState state;
  for (const double force_N : {1.0, 1.08, 0.93}) {
    buzz(Vector3d(force_N, 0, 0), 0.1, kTick_s, state);
  }
  EXPECT_EQ(state.seen, 0u);
  buzz(Vector3d(1.05, 0, 0), 0.1, kTick_s, state);
  EXPECT_EQ(state.seen, 1u);
}

TEST(BuzzDetector, AForceThatChangesSidesEveryTickMoreAndMoreIsOne) {
  std::vector<double> force_N;
  force_N.reserve(10);
  for (int i = 0; i < 10; ++i) force_N.push_back((i % 2 == 0 ? 0.3 : -0.3) * i);
  EXPECT_FALSE(spoken(force_N, 0.1).empty());
}

TEST(BuzzDetector, ItHearsInEveryDirectionAlsoAcrossASteadyForce) {
  for (int i = 0; i < 24; ++i) {
    const double angle = 2.0 * M_PI * i / 24;
    const Vector3d along(std::cos(angle), 0.3 * std::sin(angle), std::sin(angle));
    BuzzState state;
    bool heard = false;
    const std::vector<double> wave_N = wave(80.0, 0.2, 300);
    for (std::size_t tick = 0; tick < wave_N.size(); ++tick) {
      // First pushed to 2 N along z, as by a wall.
      const double wall_N = std::min(2.0, 0.05 * static_cast<double>(tick));
      const Vector3d force_N = wall_N * Vector3d::UnitZ() + (wave_N[tick] - 1.0) * along;
      heard |= buzz(force_N, 0.1, kTick_s, state);
    }
    EXPECT_TRUE(heard) << along.transpose();
  }
}

TEST(BuzzDetector, AForceThatTurnsRoundDoesNotReverse) {
  // Round a ridge, as many times as it likes.
  BuzzState state;
  for (int tick = 0; tick < 500; ++tick) {
    const double angle = 2.0 * M_PI * 40.0 * tick * kTick_s;
    buzz(Vector3d(std::cos(angle), std::sin(angle), 0.0), 0.1, kTick_s, state);
  }
  EXPECT_EQ(state.seen, 0u);
}

TEST(BuzzDetector, AfterTheBuzzItFallsSilentWithinTheWindow) {
  std::vector<double> force_N = wave(80.0, 0.2, 500);
  force_N.resize(1000, 1.0);
  EXPECT_GE(spoken(force_N, 0.1).back(), 490);
  EXPECT_LE(spoken(force_N, 0.1).back(), 550);
}

}  // namespace
}  // namespace sulcus::buzz_detector_test
