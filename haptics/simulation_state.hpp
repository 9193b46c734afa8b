#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/pose.hpp"
#include "haptics/device/device_port.hpp"
#include "haptics/kept_normals.hpp"
#include "haptics/neighbour.hpp"
#include "haptics/removal.hpp"

namespace sulcus {

/// Everything besides the workpiece's shape that can influence a later tick, advanced by the tick
/// alone, hashed in one place.
struct SimulationState {
  std::uint64_t tick = 0;  // that comes next
  bool has_pose = false;   // the tool has been somewhere: its motion is known
  Pose tool;               // world from tool, at the last tick
  DevicePortState port;
  std::optional<RemovalState> removal;      // with [cutting] only
  std::optional<KeptNormals> kept;          // with haptics.keep_normals only
  std::optional<double> spindle_rad_per_s;  // with [spindle] only: it sags under load
  std::optional<double> load_offset_m;      // with trajectory.load_N only: of the tool from the
                                            // device, along the load

  std::vector<Neighbour> neighbours;  // one for each [[body]]

  /// Of the tangential forces on all bodies, all ticks.
  double work_J() const;
  std::uint64_t hash() const;
};

/// The state before the first tick, with what the scene names but its neighbours, whose voxels the
/// caller has. Until a device has given a pose, the tool is at `start`, where it touches nothing.
SimulationState initial_state(const Scene& scene, const VoxelGrid& grid, const Pose& start = {});

}  // namespace sulcus
