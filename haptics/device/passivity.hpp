#pragma once

#include <cstdint>

#include "engine/core/pose.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/tool_motion.hpp"

namespace sulcus {

/// A sampled wall gives out energy: its force, held over a tick, lags half a tick behind the
/// motion, and with every step dx of a spring of stiffness K the hand gets K dx^2 / 2 more than the
/// spring had. The observer [Hannaford and Ryu 2002] adds up what passes the device's port; the
/// controller takes back out of the motion what was given. So it does with the energy of a force
/// that has no potential, round an edge for example, which gives out something new with every turn
/// of a closed way. Once a tick, in this order:
///
///   observe_passivity(reference, state)
///   wrench = control_passivity(wanted, settings, state)      only where a scene asks for it
///   sent = limit_output(wrench, ...)
///   hold_wrench(sent, settings, state)                    without `control`, the observer alone
struct PassivitySettings {
  double limit_N = 3.3;             // the damping takes no force beyond it
  double damping_N_s_per_m = 10.0;  // of a leak, at most; mass / tick, 45 for 45 g, would stop it
  double stiffness_N_per_m = 0.0;   // of the springs that a force comes through; 0: none are known
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
  /// What the last of the way shows: means over kWay_m of it in `control_passivity`, however fast
  /// it was gone, and over ticks, however short it was.
  struct Trend {
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // of unit vectors: 1 where it is straight
    double drive_N = 0.0;            // along the way, beyond what springs give back
    double stiffness_N_per_m = 0.0;  // fall of the force along the way
    double stiffest_N_per_m = 0.0;   // of this contact
    bool has_stiffness = false;      // in this contact
    Eigen::Vector3d step_m = Eigen::Vector3d::Zero();  // in a tick
    double length_m = 0.0;                             // of steps
  };

  bool has_reference = false;
  Pose reference;                  // [observe] at the last tick
  Twist moved;                     // [observe] since the tick before: m, rad
  double energy_J = 0.0;           // [observe] since the contact began
  double least_J = 0.0;            // [observe] of the run
  Wrench contact;                  // [control] wanted, what the device renders of it
  Trend trend;                     // [control]
  double credit_J = 0.0;           // [control] what the reserve has beside the energy
  Held commanded;                  // [control]
  Held sent;                       // [hold]
  Held held;                       // [hold] what the device has over the coming tick
  double given_before_J = 0.0;     // by the contacts that are over
  double dissipated_J = 0.0;       // by the controller
  std::uint64_t damped_ticks = 0;  // on which the controller acted

  /// Sum of what was given out over the contacts of the run, the present one as it stands.
  double given_out_J() const;
};

/// Adds the energy that passed since the last tick. `reference`: world from tool, its position that
/// of the point that torques are about, of the device's own pose (not of a tool on a coupling); of
/// the last one where the device does not answer. The first call only takes the pose.
void observe_passivity(const Pose& reference, PassivityState& state) noexcept;

/// `wanted` with a damping force against the motion, for two reasons:
///
/// - A sampled force leaks. It is late by half a tick (one and a half with a delay), over which it
///   would have changed by its stiffness times the way: so much is added, kLeakMargin times.
/// - What passed the port since the contact began, less what the springs have stored of it, is the
///   reserve; a potential has no part in it, and comes back undamped. What a force drives the
///   motion with beyond that draws the reserve down: to zero, and no further. The damping that
///   takes the drive away comes with kStep_N a tick, so that it begins as early as that needs: a
///   drive f may last while f^2 / 2 kStep_N steps' way of it are in the reserve. Of a contact
///   behind springs the stored energy is F^2 / 2k; elsewhere k is the stiffest that the contact has
///   shown.
///
/// Where the reserve is overdrawn the first part grows, up to kMostLeakMargin, until it is paid.
/// Both come along with the way rather than with time, so that they do not go up and down with the
/// quanta of a slow pose. The damping changes by kStep_N a tick at most, or where a leak takes more
/// than that (a tap at 50 mm/s on 1 N/mm) by half of it. [Ryu, Kim and Hannaford 2004] have the
/// trapezoid of the wanted wrenches as a reference energy instead of the reserve: of a force
/// without a potential it says that all it gives out is its own. None in air, none that would
/// reverse the wanted force: nothing sticks.
Wrench control_passivity(const Wrench& wanted, const PassivitySettings& settings,
                         PassivityState& state) noexcept;

/// Takes what was sent, after the limits. A contact begins with the first wrench after a tick
/// without any, and the energy with it at zero: what an earlier contact's cutting dissipated would
/// hide for long what a later one gives out. A force of under a millinewton, which a coupling
/// leaves in air, is none. What the limits took is not the contact's to give or to take, so where
/// they changed the force an overdrawn reserve starts from zero.
void hold_wrench(const Wrench& sent, const PassivitySettings& settings,
                 PassivityState& state) noexcept;

}  // namespace sulcus
