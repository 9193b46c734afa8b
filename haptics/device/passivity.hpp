#pragma once

#include <cstdint>

#include "engine/core/pose.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/tool_motion.hpp"

namespace sulcus {

/// A sampled wall gives out energy: its force, held over a tick, lags half a tick behind the
/// motion, and with every step dx of a spring of stiffness K the hand gets K dx^2 / 2 more than the
/// spring had. The observer [Hannaford and Ryu 2002] adds up what passes the device's port; the
/// controller takes back out of the motion what was given. Once a tick, in this order:
///
///   observe_passivity(reference, state)
///   wrench = control_passivity(wanted, settings, state)      only where a scene asks for it
///   sent = limit_output(wrench, ...)
///   hold_wrench(sent, settings, state)                    without `control`, the observer alone
struct PassivitySettings {
  double limit_N = 3.3;             // the damping takes no force beyond it
  double damping_N_s_per_m = 10.0;  // at most; mass / tick, 45 for 45 g, would stop it at once
  bool renders_torque = false;      // the device does
  bool delayed = false;             // the device applies a wrench a tick after it was sent
  double dt_s = 1e-3;               // of a tick
};

/// Energies are those absorbed by the simulation: below zero it has given out.
struct PassivityState {
  /// A wrench for the device, and how much of its force is the controller's.
  struct Held {
    Wrench wrench{};
    Eigen::Vector3d damping_N = Eigen::Vector3d::Zero();
    bool limited =
        false;  // by a limit of the output; the damping in it is then not known, and zero here
  };

  bool has_reference = false;
  Pose reference;               // [observe] at the last tick
  Twist moved;                  // [observe] since the tick before: m, rad
  double energy_J = 0.0;        // [observe] since the contact began
  double least_J = 0.0;         // [observe] of the run
  Wrench contact;               // [control] wanted, what the device renders of it
  double lossless_J = 0.0;      // [control] what a contact that is not sampled would have absorbed
  Held commanded;               // [control]
  Held sent;                    // [hold]
  Held held;                    // [hold] what the device has over the coming tick
  double given_before_J = 0.0;  // by the contacts that are over
  double dissipated_J = 0.0;    // by the controller
  std::uint64_t damped_ticks = 0;  // on which the controller acted

  /// Sum of what was given out over the contacts of the run, the present one as it stands.
  double given_out_J() const;
};

/// Adds the energy that passed since the last tick. `reference`: world from tool, its position that
/// of the point that torques are about, of the device's own pose (not of a tool on a coupling); of
/// the last one where the device does not answer. The first call only takes the pose.
void observe_passivity(const Pose& reference, PassivityState& state) noexcept;

/// `wanted` with a damping force against the last displacement, where the contact has given out
/// more than it had. Against what a contact without sampling would have absorbed, the trapezoid of
/// the wanted wrenches [Ryu, Kim and Hannaford 2004: a reference energy], and ahead by what the
/// coming tick will leak if it is as the last: waiting until the energy itself falls below zero, as
/// the observer's authors do, leaves the last few ticks of a contact for all of it. None in air,
/// none without motion, none that would reverse the wanted force: nothing sticks.
Wrench control_passivity(const Wrench& wanted, const PassivitySettings& settings,
                         PassivityState& state) noexcept;

/// Takes what was sent, after the limits. A contact begins with the first wrench after a tick
/// without any, and the energy with it at zero: what an earlier contact's cutting dissipated would
/// hide for long what a later one gives out. What the limits took is not the contact's to give or
/// to take, so where it changed the force the reference starts from what was exchanged.
void hold_wrench(const Wrench& sent, const PassivitySettings& settings,
                 PassivityState& state) noexcept;

}  // namespace sulcus
