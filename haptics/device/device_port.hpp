#pragma once

#include <cstdint>

#include "engine/core/pose.hpp"
#include "haptics/device/buzz_detector.hpp"
#include "haptics/device/device.hpp"
#include "haptics/device/output_limiter.hpp"
#include "haptics/device/passivity.hpp"
#include "haptics/tick_context.hpp"

namespace sulcus {

/// Where poses come in and wrenches go out: what of it a later tick depends on.
struct DevicePortState {
  bool has_pose = false;
  Pose pose;  // of the device, the last that it gave; before the first where it is to start
  std::uint64_t silent_ticks = 0;  // since then
  OutputLimiterState limiter;
  PassivityState passivity;
  BuzzState buzz;
};

/// A pose as the tick takes it. One rule for a device's time, whatever gives the poses: no pose for
/// up to 20 ms is bridged, the last one stands and all goes on; for longer the device is `silent`,
/// and tool and spindle stand still, until a pose comes, while the force falls to zero
/// (limit_output). A pose more than kLongestStep_m from the last one is a jump. Of neither a jump
/// nor the way of a silence the tool has slid: no friction, nothing cut.
struct DeviceReading {
  Pose pose;    // the last one where there is none
  Pose before;  // the last one; at first the same
  bool silent = false;
  bool jumped = false;
  bool slides = true;        // `pose` is where the tool has gone since `before`
  std::uint32_t faults = 0;  // bits of Fault
};

/// Of the burr's tip and its head's other end, in a tick, at most.
inline constexpr double kLongestStep_m = 5e-3;

/// How far the tip or the head's other end goes, whichever goes further.
double step_of(const Burr& burr, const Pose& from, const Pose& to) noexcept;

/// Upper bound of the rendered stiffness, N/m; the threshold for buzz goes with it.
double felt_stiffness(const Scene& scene) noexcept;

/// Asks a device. A pose that is not finite ends the run: kFaultNotFinite, and the pose is the last
/// one.
DeviceReading read_pose(const TickContext& context, Device& device, std::uint64_t tick,
                        DevicePortState& state) noexcept;

/// From the commanded wrench to the one that is sent: the passivity observer always; with [device]
/// its controller, where the scene asks for it, and the device's limits (limit_output); with
/// [device] or [coupling] the buzz detector. A trajectory has no limits. Nothing that is not finite
/// passes: where a fault says so already, or the wrench is not, what is sent is zero at once. Adds
/// to `faults`.
Wrench render_wrench(const TickContext& context, const DeviceReading& reading,
                     const Wrench& commanded, DevicePortState& state,
                     std::uint32_t& faults) noexcept;

}  // namespace sulcus
