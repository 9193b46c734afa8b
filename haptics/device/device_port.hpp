#pragma once

#include <cstdint>

#include "engine/core/pose.hpp"
#include "haptics/device/buzz_detector.hpp"
#include "haptics/device/device.hpp"
#include "haptics/device/device_edge.hpp"
#include "haptics/device/passivity.hpp"
#include "haptics/tick_context.hpp"

namespace sulcus {

/// Where poses come in and wrenches go out: what of it a later tick depends on.
struct DevicePortState {
  bool has_pose = false;
  Pose pose;  // of the device, the last that it gave
  DeviceEdgeState edge;
  PassivityState passivity;
  BuzzState buzz;

  std::uint64_t hash() const;
};

/// A pose as the tick takes it.
struct DeviceReading {
  Pose pose;    // the last one while the device is silent
  Pose before;  // the last one; at first the same
  bool answered = true;
  bool jumped = false;       // further from the last than a hand moves a handle: 5 m/s
  std::uint32_t faults = 0;  // bits of Fault
};

/// What a hand feels a scene's contacts as stiff as, at most, N/m: what buzz is listened for with.
double felt_stiffness(const Scene& scene) noexcept;

/// Asks a device. A pose that is not finite ends the run: kFaultNotFinite, and the pose is the last
/// one.
DeviceReading read_pose(const TickContext& context, Device& device, std::uint64_t tick,
                        DevicePortState& state) noexcept;

/// From the wrench that is asked for to the one that is sent: the passivity observer always; with
/// [device] its controller, where the scene asks for it, and the device's limits (device_edge);
/// with [device] or [coupling] the buzz detector. A trajectory has no limits. Adds to `faults`.
Wrench render_wrench(const TickContext& context, const DeviceReading& reading, const Wrench& asked,
                     DevicePortState& state, std::uint32_t& faults) noexcept;

}  // namespace sulcus
