#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// What a hand did in one tick.
struct HandTick {
  std::uint64_t tick = 0;
  Eigen::Vector3d tip_m;  // of the burr, world space
  Eigen::Vector3d axis;   // from tip to shank, a unit vector
  double force_N = 0.0;   // magnitude, as it was felt
  bool in_contact = false;
};

/// What came off in one tick.
struct HandRemoval {
  std::uint64_t tick = 0;
  std::size_t tissue = 0;
  double mm3 = 0.0;
};

/// A figure, and the place of its tick among those of the hand.
struct HandFigure {
  double value = 0.0;
  std::size_t at = 0;
};

/// How a hand worked, as studies of dentists have it. A stroke is a time in contact: gaps of up to
/// 0.05 s do not end it, and one of less than 0.05 s is none [Liao 1995: 1.36 a second, of 0.37 s].
struct HandProcess {
  std::size_t strokes = 0;
  double stroke_s = 0.0;         // of one, the mean; 0 without any
  double stroke_mm = 0.0;        // the way of the tip in one, the mean
  double strokes_per_s = 0.0;    // from the first contact to the last
  double path_mm = 0.0;          // of the tip, all of it
  std::size_t pauses = 0;        // of a second and more without contact, between contacts
  double longest_pause_s = 0.0;  // of those
  double over_force_s = 0.0;     // above the force asked about
  // In contact; none without any.
  std::optional<double> median_force_N, p95_force_N, burr_angle_deg;
  std::optional<HandFigure> greatest_force_N, greatest_burr_angle_deg;
  /// Log dimensionless jerk, the mean of the strokes: a larger one (nearer to 0) is smoother; a
  /// single reach with the least jerk has -5.3. [Balasubramanian 2015, eq. 8]
  std::optional<double> smoothness;
};

/// `ticks` rise by one, at `rate_hz`, but where ticks were not recorded; `over_N`: above which
/// over_force_s counts; `insertion`: what the burr's angle is against, a unit vector.
HandProcess hand_process(std::span<const HandTick> ticks, double rate_hz, double over_N,
                         const Eigen::Vector3d& insertion);

/// Of the burr's axis, from tip to shank, against the path of insertion.
double burr_angle_deg(const Eigen::Vector3d& axis, const Eigen::Vector3d& insertion);

/// How fast a tissue went, mm3/s: its volume, over the time that was spent on it. Time is parted
/// into tenths of a second; one in which something went was spent on the tissue of which most did.
/// 0 where none was. `removals` in the order of their ticks.
double removal_rate(std::span<const HandRemoval> removals, std::size_t tissue, double rate_hz);

}  // namespace sulcus
