#include "app/frame_history.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/units.hpp"

namespace sulcus {

FrameHistory::FrameHistory(const Scene& scene)
    : title_(scene.title),
      window_(static_cast<std::size_t>(std::max(2.0, 2.0 * scene.haptics.rate_hz))),
      dt_s_(1.0 / scene.haptics.rate_hz),
      set_speed_rad_per_s_(scene.cutting ? scene.burr.speed_rad_per_s : 0.0),
      voxel_mm3_(std::pow(scene.workpiece.voxel_m / kMillimetre, 3)),
      cutting_(scene.cutting.has_value()) {}

void FrameHistory::add(const TickReport& report) {
  add(report.record, cutting_ ? &report.cutting : nullptr);
  for (std::size_t s = 0; s < stage_us_.size(); ++s) {
    const double us = static_cast<double>(report.stage_us[s]);
    stage_us_[s] = timed_ ? stage_us_[s] + 0.01 * (us - stage_us_[s]) : us;
  }
  timed_ = true;
}

void FrameHistory::add(const TickRecord& record, const CuttingRecord* cutting) {
  latest_ = record;
  const double speed_rad_per_s = cutting ? cutting->spindle_rad_per_s : set_speed_rad_per_s_;
  turn_rad_ = std::fmod(turn_rad_ + speed_rad_per_s * dt_s_, 2.0 * std::numbers::pi);
  removed_ += record.removed;
  // Twice the window is kept, so that the front is cut off once in a window and not every tick.
  if (force_N_.size() >= 2 * window_) {
    for (auto* values : {&force_N_, &torque_mNm_, &tick_us_}) {
      values->erase(values->begin(), values->end() - static_cast<std::ptrdiff_t>(window_));
    }
  }
  const Eigen::Vector3d force(record.force_N[0], record.force_N[1], record.force_N[2]);
  const Eigen::Vector3d torque(record.torque_Nm[0], record.torque_Nm[1], record.torque_Nm[2]);
  force_N_.push_back(static_cast<float>(force.norm()));
  torque_mNm_.push_back(static_cast<float>(torque.norm() * 1e3));
  tick_us_.push_back(record.step_us);
}

FrameState FrameHistory::state() const {
  const auto last = [this](const std::vector<float>& values) {
    return std::span<const float>(values).last(std::min(window_, values.size()));
  };
  FrameState state;
  state.title = title_;
  state.time_s = latest_.time_s;
  state.tick = latest_.tick;
  const double* p = latest_.tool_position_m;
  const double* q = latest_.tool_orientation;
  state.world_from_tool = {{p[0], p[1], p[2]}, Eigen::Quaterniond(q[0], q[1], q[2], q[3])};
  state.burr_turn_rad = turn_rad_;
  for (int a = 0; a < 3; ++a) {
    state.force_N[a] = latest_.force_N[a];
    state.torque_Nm[a] = latest_.torque_Nm[a];
  }
  state.contacts = latest_.contacts;
  state.tick_us = latest_.step_us;
  state.removed_mm3 = static_cast<double>(removed_) * voxel_mm3_;
  for (std::size_t s = 0; timed_ && s < stage_us_.size(); ++s) {
    if (Stage(s) == Stage::kRemoval && !cutting_) continue;  // was not there
    state.stages.push_back({kStageNames[s], stage_us_[s]});
  }
  state.force_history_N = last(force_N_);
  state.torque_history_mNm = last(torque_mNm_);
  state.tick_history_us = last(tick_us_);
  return state;
}

}  // namespace sulcus
