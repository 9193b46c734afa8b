#pragma once

#include "engine/scene/scene.hpp"

namespace sulcus {

/// Speed of the spindle a tick later, rad/s: the motor drives with a torque that falls in a
/// straight line from its stall torque at rest to nothing at the free speed, as an air turbine's
/// does, and `load_Nm`, what the tooth holds against it about the burr's axis, brakes:
///
///   inertia dw/dt = stall (1 - w / w_free) - load
///
/// Under a constant load it settles at w_free (1 - load / stall), and it recovers with the time
/// inertia w_free / stall. The motor's part is taken implicitly, so that no rate makes it unstable.
/// Never below zero: the tooth brakes and does not drive.
double spindle_speed(const SpindleSettings& settings, double free_rad_per_s, double now_rad_per_s,
                     double load_Nm, double dt_s) noexcept;

}  // namespace sulcus
