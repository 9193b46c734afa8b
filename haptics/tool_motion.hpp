#pragma once

#include "engine/core/pose.hpp"
#include "haptics/contact/contact.hpp"

namespace sulcus {

/// The turn that takes `from` to `to`, the short way round, as twice its quaternion's vector part:
/// the rotation vector, rad, as far as a turn is small. 2 long at most.
inline Eigen::Vector3d small_turn(const Eigen::Quaterniond& from,
                                  const Eigen::Quaterniond& to) noexcept {
  const Eigen::Quaterniond turn = to * from.conjugate();
  return (turn.w() < 0.0 ? -2.0 : 2.0) * turn.vec();
}

/// The tool's motion in the tick that takes it from `from` to `to`, whose turn is small.
inline Twist motion_between(const Pose& from, const Pose& to, double dt_s,
                            double spindle_rad_per_s) noexcept {
  return {(to.position - from.position) / dt_s, small_turn(from.orientation, to.orientation) / dt_s,
          spindle_rad_per_s};
}

}  // namespace sulcus
