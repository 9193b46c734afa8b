#pragma once

#include <vector>

#include "engine/core/pose.hpp"
#include "engine/volume/workpiece.hpp"
#include "tools/sulcus_lab/ticks/ticks_path.hpp"

namespace sulcus::lab {

/// How a burr cuts with an even number of voxels in contact.
struct CuttingPlan {
  double specific_energy_J_per_m3 = 0.0;
  std::vector<Pose> poses;  // one for each tick
};

/// The specific energy of which as large a share of the voxels in contact goes in a tick as in the
/// paper's cutting experiment, one in 695, at 7,000 rpm. From trial runs with ldm_fast, of `ticks`
/// at most.
double find_specific_energy(const Workpiece& workpiece, const TickPath& path, int wanted,
                            int ticks);

/// Finds poses for that many ticks along a path while cutting: the tool sinks with the ground that
/// it takes away, a few um a tick (it moves 10 along the path), each place of the path as much as
/// keeps `wanted` voxels in contact there. What `haptics` says shapes the ground, so that every
/// method has poses of its own.
CuttingPlan plan_cutting(const Workpiece& workpiece, const TickPath& path, int wanted, int ticks,
                         double specific_energy_J_per_m3, const HapticsSettings& haptics);

}  // namespace sulcus::lab
