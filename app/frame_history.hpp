#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "app/feed.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/recording/tick_record.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// Collects rows of ticks into what a frame shows: the latest values, and curves of the last two
/// seconds.
class FrameHistory {
 public:
  explicit FrameHistory(const Scene& scene);

  /// `cutting`: the row of the same tick, where there is one.
  void add(const TickRecord& record, const CuttingRecord* cutting);
  /// With the times of its stages, which a recording does not hold.
  void add(const TickReport& report);
  bool empty() const { return force_N_.empty(); }
  /// Valid until the next `add`.
  FrameState state() const;

 private:
  std::string title_;
  std::size_t window_;                                  // ticks
  double dt_s_, set_speed_rad_per_s_, turn_rad_ = 0.0;  // of the spindle
  double voxel_mm3_;
  TickRecord latest_;
  std::uint64_t removed_ = 0;
  std::vector<float> force_N_, torque_mNm_, tick_us_;
  bool cutting_, timed_ = false;
  std::array<double, kStageCount> stage_us_{};  // over about the last hundred ticks
};

}  // namespace sulcus
