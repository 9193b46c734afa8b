#include "haptics/device/buzz_detector.hpp"

#include <algorithm>

namespace sulcus {

namespace {

constexpr double kWindow_s = 0.07, kSlow_s = 0.033, kShortWindow_s = 0.047, kSilence_s = 0.05;
/// Of a swing to that before the last. Impacts that die away lose more than that, but for the
/// rounding to quanta, on which two swings in a row may be equal though the motion dies.
constexpr double kSustained = 0.95;
/// Of two swings in a row, where fewer are asked for: with rounding alone.
constexpr double kKept = 0.99, kMostOfForce = 0.5;

void note(double swing_N, BuzzState& state) {
  std::shift_left(state.swings_N.begin(), state.swings_N.end(), 1);
  std::shift_left(state.seen_ticks.begin(), state.seen_ticks.end(), 1);
  state.swings_N.back() = swing_N;
  state.seen_ticks.back() = state.tick;
  ++state.seen;
}

/// Follows the force from one turning point to the next, and notes where it reverses.
void follow(const Eigen::Vector3d& force_N, double threshold_N, BuzzState& state) {
  const Eigen::Vector3d swing_N = state.furthest_N - state.turn_N;
  const double length_N = swing_N.norm();
  if ((force_N - state.turn_N).norm() > length_N) {
    // Still going on, unless it has crossed over to the other side of where it began.
    if ((force_N - state.turn_N).dot(swing_N) >= 0.0 || length_N <= threshold_N) {
      state.furthest_N = force_N;
      return;
    }
  }
  const Eigen::Vector3d back_N = force_N - state.furthest_N;
  const double back_length_N = back_N.norm();
  if (back_length_N <= threshold_N) return;
  const bool reverses = back_N.dot(swing_N) < -0.5 * back_length_N * length_N;
  if (reverses && length_N > threshold_N) note(length_N, state);
  state.turn_N = state.furthest_N;
  state.furthest_N = force_N;
}

/// Whether the last `count` reversals were seen within a time, and each of their swings is at least
/// `kept` of that `apart` before.
bool sustained(const BuzzState& state, std::size_t count, std::size_t apart, double kept,
               double window_s, double dt_s) {
  if (state.seen < count) return false;
  const std::size_t first = BuzzState::kReversals - count;
  if (static_cast<double>(state.tick - state.seen_ticks[first]) * dt_s > window_s) return false;
  for (std::size_t i = first + apart; i < BuzzState::kReversals; ++i) {
    if (state.swings_N[i] < kept * state.swings_N[i - apart]) return false;
  }
  return true;
}

}  // namespace

bool buzz(const Eigen::Vector3d& force_N, double threshold_N, double dt_s,
          BuzzState& state) noexcept {
  ++state.tick;
  if (!state.started) {
    state.started = true;
    state.turn_N = state.furthest_N = force_N;
  }
  follow(force_N, threshold_N, state);
  if (static_cast<double>(state.tick - state.seen_ticks.back()) * dt_s > kSilence_s) return false;
  // Four reversals of a faster one are soon there.
  const std::uint64_t last_three = state.seen_ticks.back() - state.seen_ticks[1];
  const bool is_slow = static_cast<double>(last_three) * dt_s >= kSlow_s;
  const double most_N = std::max(state.turn_N.norm(), state.furthest_N.norm());
  const bool is_most = state.swings_N.back() >= kMostOfForce * most_N;
  return sustained(state, 4, 2, kSustained, kWindow_s, dt_s) ||
         (is_slow && is_most && sustained(state, 3, 1, kKept, kShortWindow_s, dt_s));
}

}  // namespace sulcus
