#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace sulcus {

/// What the detector has seen of a force.
struct BuzzState {
  static constexpr std::size_t kReversals = 4;

  bool started = false;
  Eigen::Vector3d turn_N = Eigen::Vector3d::Zero();      // where the present swing began
  Eigen::Vector3d furthest_N = Eigen::Vector3d::Zero();  // how far it has come
  std::uint64_t tick = 0;
  std::uint64_t seen = 0;                              // reversals of the run
  std::array<double, kReversals> swings_N{};           // that ended in the last ones, oldest first
  std::array<std::uint64_t, kReversals> seen_ticks{};  // at which those were seen
};

/// Whether a force buzzes, at a tick of `dt_s`: true when the last reversal was seen within 50 ms
/// and the swings do not die away. That is
/// - its last three reversals took 33 to 47 ms, each swing at least 0.99 of the last and the
///   last at least half of the force: the second time that a heavy arm comes back, from 22 Hz on,
///   as slowly as it begins to; or
/// - the last four within 70 ms, each at least 0.95 of that before the last, which went the same
///   way: for swings that quanta make uneven.
/// A reversal is seen when the force has come back from where it was furthest by more than
/// `threshold_N`, along the line on which it came but for 60 degrees: so it is counted along
/// whatever direction the force changes in, and a force that turns a corner does not reverse. The
/// threshold is to lie above what a device's resolution makes of a wall of stiffness K at rest,
/// which is under 1.5 K x resolution: see buzz_threshold_N. Once a tick, with the force that is
/// commanded, before any limit.
bool buzz(const Eigen::Vector3d& force_N, double threshold_N, double dt_s,
          BuzzState& state) noexcept;

/// Of a contact or a coupling of stiffness K: two of the device's quanta, and what a hand feels.
constexpr double buzz_threshold_N(double stiffness_N_per_m, double resolution_m) noexcept {
  constexpr double kLeastFelt_N = 0.05;
  const double quanta_N = 2.0 * stiffness_N_per_m * resolution_m;
  return quanta_N > kLeastFelt_N ? quanta_N : kLeastFelt_N;
}

}  // namespace sulcus
