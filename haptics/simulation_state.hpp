#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/pose.hpp"
#include "haptics/body.hpp"
#include "haptics/device/device_port.hpp"

namespace sulcus {

/// Everything that can influence a later tick, advanced by the tick alone, hashed in one place.
struct SimulationState {
  std::uint64_t tick = 0;  // number of the next tick
  bool has_pose = false;   // the tool has been somewhere: its motion is known
  Pose tool;               // world from tool, at the last tick
  DevicePortState port;
  std::optional<double> spindle_rad_per_s;  // with [spindle] only: it sags under load
  double pedal = 1.0;  // of the tick in hand, which reads it anew: of no hash, in no keyframe
  std::optional<double> load_offset_m;  // with trajectory.load_N only: of the tool from the
                                        // device, along the load
  std::vector<Body> bodies;             // 0 the workpiece, then one for each [[body]]

  Body& workpiece() { return bodies.front(); }
  const Body& workpiece() const { return bodies.front(); }
  std::span<const Body> others() const { return std::span(bodies).subspan(1); }

  /// Of the tangential forces on all bodies, all ticks.
  double work_J() const;
  /// Of all but the workpiece's voxels, which have a hash of their own.
  std::uint64_t hash() const;
};

/// The state before the first tick; `starts` as make_bodies takes them. Until a device has given a
/// pose, the tool is at `start`, where it touches nothing.
SimulationState initial_state(const Scene& scene, std::vector<Workpiece> starts,
                              const Pose& start = {});

}  // namespace sulcus
