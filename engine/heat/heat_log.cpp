#include "engine/heat/heat_log.hpp"

#include <algorithm>
#include <cmath>

namespace sulcus {

namespace {

constexpr double kStretch_s = 0.01;

}  // namespace

HeatLog::HeatLog(double rate_hz, std::uint64_t first_tick)
    : rate_hz_(rate_hz),
      stretch_ticks_(std::max<std::uint64_t>(
          1, static_cast<std::uint64_t>(std::lround(kStretch_s * rate_hz)))),
      first_tick_(first_tick) {}

std::uint32_t HeatLog::stretch_of(std::uint64_t tick) {
  const std::uint64_t at = (tick - first_tick_) / stretch_ticks_;
  if (stretches_.size() <= at) stretches_.resize(at + 1);
  return static_cast<std::uint32_t>(at);
}

void HeatLog::add(const TickRecord& record, const CuttingRecord& cutting) {
  Stretch& stretch = stretches_[stretch_of(record.tick)];
  // What was done before the first row of a run that goes on from another is none of its own.
  const double before_J = work_J_.value_or(record.tick > 0 ? cutting.work_J : 0.0);
  stretch.work_J += cutting.work_J - before_J;
  work_J_ = cutting.work_J;
  stretch.has_rows = true;
  stretch.turns = cutting.spindle_rad_per_s > 0.0;
  stretch.tip_world = Eigen::Vector3d(record.tool_position_m);
}

void HeatLog::add(const Edit& edit) {
  if (!edit.is_gone()) return;
  gone_.push_back({stretch_of(edit.tick), edit.voxel, edit.body, edit.cause});
}

}  // namespace sulcus
