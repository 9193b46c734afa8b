#pragma once

#include <cstdint>

#include "haptics/contact/contact.hpp"

namespace sulcus {

/// What a device can be asked for. The steps are far above what a coupling asks for and below what
/// throws a hand: 20 mm/s and one quantum of 55 um against 1.2 N/mm, the stiffest coupling here,
/// make 0.09 N a tick, and only 360 mm/s reach 0.5 N, so that contact and buzz come through as they
/// are; a wrong force of one tick gives the 45 g that a hand holds of a device at most 11 mm/s,
/// half of a slow approach; and a device's whole 3.3 N come within 7 ms. The torque's step is that
/// force at the tip, 40 mm from the reference point.
struct OutputLimits {
  double force_N = 3.3;          // magnitude; 0: it renders none
  double torque_Nm = 0.0;        // likewise
  double force_step_N = 0.5;     // magnitude of the change in a tick
  double torque_step_Nm = 0.02;  // likewise
  double dt_s = 1e-3;            // of a tick
};

/// What was sent, and in how many ticks which limit changed it.
struct OutputLimiterState {
  Wrench sent;        // in the last tick
  double ramp = 0.0;  // 0 to 1
  std::uint64_t not_finite_ticks = 0;
  std::uint64_t clamped_ticks = 0;
  std::uint64_t ramped_ticks = 0;
  std::uint64_t step_limited_ticks = 0;
};

/// What the device's poses say about a tick.
struct DeviceAnswer {
  bool silent = false;  // no pose for longer than is bridged: the ramp falls
  bool jumped = false;  // further than a hand moves it in a tick: the ramp starts anew
};

/// What is sent to a device of a finite wrench. In this order:
/// - clamped in magnitude, the direction kept;
/// - ramped, from 0 in the first tick to 1 after 0.1 s. In silence, while `wanted` is that of the
///   last pose, the ramp falls from 1 to 0 in 50 ms, and then rises again from where it is. Ramped
///   after the clamp: of a large wanted force, too, only a small part is sent at first;
/// - no further from what was sent before than the steps, so that none of the above jumps.
/// Force and torque each by themselves. A part whose limit is 0 is not rendered and not counted.
Wrench limit_output(const Wrench& wanted, const OutputLimits& limits, const DeviceAnswer& answer,
                    OutputLimiterState& state) noexcept;

/// In a tick in which something was not finite, which ends the run: zero force at once, whatever
/// was sent before. What the hand still holds then is taken off by ForceFade.
Wrench cut_off(OutputLimiterState& state) noexcept;

}  // namespace sulcus
