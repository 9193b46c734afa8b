#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/session/feed.hpp"
#include "app/session/simulation.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/graphics/rendered_body.hpp"
#include "engine/outcome/preparation_progress.hpp"
#include "engine/recording/earlier_run.hpp"
#include "engine/recording/tick_record.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// The workpiece and the other bodies of a scene, as a drawing takes them.
std::vector<RenderedBody> rendered_bodies(const Scene& scene, VoxelModel workpiece,
                                          std::vector<VoxelModel> bodies);
/// Those of a simulation, as they are now.
std::vector<RenderedBody> rendered_bodies(const Simulation& simulation);

/// Collects rows of ticks into what a frame shows: the latest values, and curves of the last two
/// seconds, what has been removed so far.
class FrameHistory {
 public:
  /// `start`: the workpiece before the first tick. `earlier`: what came before that, of a run that
  /// goes on from another, null else: what has been removed is that of the whole.
  /// Neither is kept.
  FrameHistory(const Scene& scene, const VoxelModel& start, const EarlierRun* earlier = nullptr);

  /// `cutting`, `port`: the rows of the same tick, where there are any.
  void add(const TickRecord& record, const CuttingRecord* cutting,
           const PortRecord* port = nullptr);
  /// With the times of its stages, which a recording does not hold.
  void add(const TickReport& report);
  /// Of any body; in the order of a run.
  void add(const Edit& edit);
  bool empty() const { return force_N_.empty(); }
  /// Valid until the next `add`.
  FrameState state() const;

 private:
  std::vector<OutcomeLine> outcome() const;
  double seconds(std::uint64_t ticks) const { return static_cast<double>(ticks) * dt_s_; }
  void add_warnings(std::vector<OutcomeLine>& lines) const;

  std::string title_;
  std::size_t window_;                                  // ticks
  double dt_s_, set_speed_rad_per_s_, turn_rad_ = 0.0;  // of the spindle
  double voxel_mm3_;
  TickRecord latest_;
  std::optional<PreparationProgress> progress_;  // with [cutting]
  struct Damage {
    std::string name;
    double voxel_mm3;
    std::uint64_t removed;
  };
  std::vector<Damage> damage_;  // of each other body
  std::vector<std::string> tissues_;
  RunMeasures measures_;
  std::vector<float> force_N_, torque_mNm_, tick_us_;
  std::vector<float> spindle_krpm_, pulp_mm_;  // with [spindle]; with a pulp
  bool cutting_, port_, sags_, timed_ = false;
  std::optional<double> latest_spindle_rad_per_s_;  // with [spindle]
  double given_out_J_ = 0.0;                        // with [device] or [coupling]
  std::array<double, kStageCount> stage_us_{};      // over about the last hundred ticks
};

}  // namespace sulcus
