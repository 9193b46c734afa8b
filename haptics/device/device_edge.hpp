#pragma once

#include <cstdint>

#include "haptics/contact.hpp"

namespace sulcus {

/// What a device can be asked for. The steps are far above what a coupling asks for and below what
/// throws a hand: 20 mm/s and one quantum of 55 um against 1.2 N/mm, the stiffest coupling here,
/// make 0.09 N a tick, and only 360 mm/s reach 0.5 N, so that contact and buzz come through as they
/// are; a wrong force of one tick gives the 45 g that a hand holds of a device at most 11 mm/s,
/// half of a slow approach; and a device's whole 3.3 N come within 7 ms. The torque's step is that
/// force at the tip, 40 mm from the reference point.
struct DeviceEdgeLimits {
  double force_N = 3.3;          // magnitude; 0: it renders none
  double torque_Nm = 0.0;        // likewise
  double force_step_N = 0.5;     // magnitude of the change in a tick
  double torque_step_Nm = 0.02;  // likewise
  double dt_s = 1e-3;            // of a tick
};

/// What was sent, and on how many ticks the edge changed what was wanted.
struct DeviceEdgeState {
  Wrench sent;        // in the last tick
  double ramp = 0.0;  // 0 to 1
  std::uint64_t not_finite_ticks = 0;
  std::uint64_t clamped_ticks = 0;
  std::uint64_t ramped_ticks = 0;
  std::uint64_t step_limited_ticks = 0;
};

/// What is sent to a device of what is wanted, which is finite. In this order:
/// - clamped in magnitude, the direction kept;
/// - ramped, from 0 in the first tick to 1 after 0.1 s. While the device is `silent` the ramp
/// falls,
///   from 1 to 0 in 50 ms, `wanted` being that of the last pose, and rises again from where it has
///   come to; after it has `jumped`, its pose further off than a hand moves it in a tick, it starts
///   anew. Ramped after the clamp: of a large wanted force, too, only a small part is sent at
///   first;
/// - never further from what was sent before than the steps, so that nothing of the above jumps.
/// Force and torque each by themselves. A part whose limit is 0 is not rendered and not counted.
Wrench device_edge(const Wrench& wanted, const DeviceEdgeLimits& limits, bool answered, bool jumped,
                   DeviceEdgeState& state) noexcept;

/// The edge of a tick in which something was not finite, which ends the run: zero force at once,
/// whatever was sent before. What the hand still holds then is taken off by ForceFade.
Wrench cut_off(DeviceEdgeState& state) noexcept;

}  // namespace sulcus
