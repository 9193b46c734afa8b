#pragma once

#include "engine/core/pose.hpp"
#include "haptics/contact.hpp"

namespace sulcus {

/// The tool's motion in the tick that takes it from `from` to `to`. For the small turns of one tick
/// twice the vector part of the turn's quaternion is its angle.
inline Twist motion_between(const Pose& from, const Pose& to, double dt_s,
                            double spindle_rad_per_s) noexcept {
  Eigen::Quaterniond turn = to.orientation * from.orientation.conjugate();
  if (turn.w() < 0.0) turn.coeffs() = -turn.coeffs();
  return {(to.position - from.position) / dt_s, 2.0 * turn.vec() / dt_s, spindle_rad_per_s};
}

}  // namespace sulcus
