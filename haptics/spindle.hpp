#pragma once

#include "engine/scene/scene.hpp"

namespace sulcus {

/// Speed of the spindle a tick later, rad/s. The motor's torque falls from its largest, `stall`, in
/// a straight line to nothing at the free speed, over the share `droop` of it: 1 is a straight line
/// from rest, as an air turbine's, little a motor that holds its speed. It gives no more than
/// `power`, where there is a limit. `load_Nm`, what the tooth holds against it about the burr's
/// axis, brakes:
///
///   inertia dw/dt = min(stall, stall (1 - w / w_free) / droop, power / w) - load
///
/// With droop = 1 and no limit it settles at w_free (1 - load / stall) under a constant load, and
/// recovers with the time inertia w_free / stall. The motor's part is taken implicitly, so that no
/// rate makes it unstable. Never below zero: the tooth brakes and does not drive.
double spindle_speed(const SpindleSettings& settings, double free_rad_per_s, double now_rad_per_s,
                     double load_Nm, double dt_s) noexcept;

}  // namespace sulcus
