#pragma once

#include <cstdint>
#include <vector>

#include "app/session/feed.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/heat/heat_log.hpp"
#include "engine/heat/tooth_heat.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// How warm the pulp is while a tooth is cut, for a window: as the summary will have it, up to the
/// last whole stretch of the log. Used by the thread that draws; a step of 10 ms takes some 2 ms.
class LiveHeat {
 public:
  /// `scene` has [heat]. `start`: the workpiece before the first tick, which is number
  /// `first_tick`; not kept.
  LiveHeat(const Scene& scene, const VoxelModel& start, std::uint64_t first_tick);

  /// In the order of a run; a tick's edits before or after it.
  void add(const TickReport& report);
  void add(const Edit& edit) { log_.add(edit); }
  /// By how much the pulp's wall is warmer than at the start, and a warning once it was beyond
  /// kPulpLimit_K. None of a tooth without a pulp.
  std::vector<OutcomeLine> lines();

 private:
  HeatLog log_;
  ToothHeat tooth_;
  double latest_s_ = 0.0;
};

}  // namespace sulcus
