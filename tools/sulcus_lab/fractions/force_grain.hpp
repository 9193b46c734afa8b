#pragma once

#include <span>

#include <Eigen/Core>

namespace sulcus::lab {

/// How even a force is while a tool goes straight on and cuts.
struct ForceGrain {
  int ticks = 0;                // that it is of
  double mean_N = 0.0;          // of the force's size
  double grain_pct = 0.0;       // RMS of the residual, of that mean
  double largest_step_N = 0.0;  // from a tick to the next
};

/// Of the device's positions (m) and the forces (N), a row for each tick. The residual of a tick is
/// what its force is off a quadratic that fits the 41 ticks around it best. Ticks within 60 of a
/// corner of the way, or within 20 of a force under 0.02 N, are left out, and so are those whose
/// quadratic would reach into them. All 0 where no tick is left.
ForceGrain force_grain(std::span<const Eigen::Vector3d> positions_m,
                       std::span<const Eigen::Vector3d> forces_N);

}  // namespace sulcus::lab
