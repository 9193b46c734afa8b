#include "app/session/frame_history.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/terminal/terminal.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

/// What the time of a tick goes to, in the order of Stage, for somebody who is not to know the
/// names of its parts.
constexpr std::array<const char*, kStageCount> kShownStages{
    "finding the tooth", "voxels in contact", "surface normals", "force", "cutting"};

double voxel_mm3(const WorkpieceSettings& solid) {
  return std::pow(solid.voxel_m / kMillimetre, 3);
}

std::string mm3(double value) { return formatted("%.3f mm\xC2\xB3", value); }

/// A name of a scene's in the room that there is for it.
std::string shortened(const std::string& name) {
  constexpr std::size_t kMost = 18;
  if (name.size() <= kMost) return name;
  std::size_t end = kMost - 2;
  while (end > 0 && (name[end] & 0xc0) == 0x80) --end;  // no character is cut in two
  return name.substr(0, end) + "..";
}

}  // namespace

std::vector<RenderedBody> rendered_bodies(const Scene& scene, VoxelModel workpiece,
                                          std::vector<VoxelModel> bodies) {
  std::vector<TissueLook> looks;
  for (const TissueSettings& tissue : scene.tissues) looks.push_back({tissue.name, tissue.colour});
  std::vector<RenderedBody> rendered{{std::move(workpiece), looks, {}}};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodySettings& body = scene.bodies[i];
    rendered.push_back({std::move(bodies[i]),
                        body.tissue ? std::vector{looks[*body.tissue]} : looks,
                        body.world_from_grid});
  }
  return rendered;
}

std::vector<RenderedBody> rendered_bodies(const Simulation& simulation) {
  return rendered_bodies(simulation.scene(), simulation.workpiece().model(),
                         simulation.other_bodies());
}

FrameHistory::FrameHistory(const Scene& scene, const VoxelModel& start, const EarlierRun* earlier)
    : title_(scene.title),
      window_(static_cast<std::size_t>(std::max(2.0, 2.0 * scene.haptics.rate_hz))),
      dt_s_(1.0 / scene.haptics.rate_hz),
      set_speed_rad_per_s_(scene.cutting ? scene.burr.speed_rad_per_s : 0.0),
      voxel_mm3_(voxel_mm3(scene.workpiece)),
      cutting_(scene.cutting.has_value()),
      port_(scene.device || scene.coupling),
      sags_(scene.spindle.has_value()) {
  if (cutting_) {
    progress_.emplace(earlier ? earlier->start : start, scene.tissues, scene.least_pulp_distance_m);
  }
  for (const TissueSettings& tissue : scene.tissues) tissues_.push_back(shortened(tissue.name));
  for (const BodySettings& body : scene.bodies) {
    damage_.push_back({shortened(body.name), voxel_mm3(body.solid), 0});
  }
  if (!earlier) return;
  measures_ = earlier->measures;
  for (const Edit& edit : earlier->edits) add(edit);
}

void FrameHistory::add(const Edit& edit) {
  if (progress_) progress_->add(edit);
  if (edit.body > 0 && edit.is_gone()) ++damage_[edit.body - 1u].removed;
}

std::vector<OutcomeLine> FrameHistory::outcome() const {
  std::vector<OutcomeLine> lines;
  if (progress_) {
    for (std::size_t t = 0; t < tissues_.size() && tissues_.size() > 1; ++t) {
      const double volume = progress_->removed_volume(EditCause::kCut, t) +
                            progress_->removed_volume(EditCause::kLoose, t);
      if (volume == 0.0) continue;
      lines.push_back({"  " + tissues_[t], mm3(volume * voxel_mm3_)});
    }
    if (const auto left = progress_->caries_left()) {
      lines.push_back({"Caries left", mm3(*left * voxel_mm3_)});
    }
    if (progress_->has_pulp()) {
      const std::optional<std::uint64_t> tick = progress_->pulp_exposed_tick();
      lines.push_back(
          {"Pulp", tick ? formatted("exposed at %.1f s", seconds(*tick)) : "not exposed"});
      if (const auto wall_m = progress_->wall_over_pulp_m(); wall_m && !tick) {
        lines.push_back({"Tooth over it", formatted("%.2f mm", *wall_m / kMillimetre)});
      }
    }
  }
  for (const Damage& body : damage_) {
    if (body.removed == 0) continue;
    lines.push_back({body.name, mm3(static_cast<double>(body.removed) * body.voxel_mm3)});
  }
  if (progress_ && measures_.ticks_in_contact > 0) {
    lines.push_back({"Peak force", formatted("%.2f N", measures_.peak_force_N)});
    lines.push_back({"Mean force", formatted("%.2f N", measures_.mean_force_in_contact_N())});
    lines.push_back({"Contact time", formatted("%.1f s", seconds(measures_.ticks_in_contact))});
  }
  if (latest_spindle_rad_per_s_) {
    const double speed = *latest_spindle_rad_per_s_;
    const double sag = set_speed_rad_per_s_ > 0.0 ? 1.0 - speed / set_speed_rad_per_s_ : 0.0;
    lines.push_back({"Spindle", formatted("%.0f rpm, -%.0f %%", speed / kRevolutionPerMinute,
                                          100.0 * std::max(0.0, sag))});
  }
  add_warnings(lines);
  return lines;
}

/// What somebody should look at; nothing where all is well.
void FrameHistory::add_warnings(std::vector<OutcomeLine>& lines) const {
  if (progress_ && progress_->pulp_near_tick()) {
    lines.push_back(
        {"Near the pulp", formatted("since %.1f s", seconds(*progress_->pulp_near_tick()))});
  }
  if (given_out_J_ >= 1e-5) {
    lines.push_back({"Energy given out", formatted("%.2f mJ", given_out_J_ * 1e3)});
  }
  for (const auto& [name, ticks] :
       {std::pair{"Force limited for", measures_.limited_ticks},
        std::pair{"Buzz", measures_.buzz_ticks}, std::pair{"Device silent", measures_.silent_ticks},
        std::pair{"Device jumped", measures_.jumped_ticks},
        std::pair{"Step too long", measures_.long_step_ticks},
        std::pair{"Burr inside", measures_.inside_ticks}}) {
    if (ticks > 0) lines.push_back({name, formatted("%.3f s", seconds(ticks))});
  }
}

void FrameHistory::add(const TickReport& report) {
  add(report.record, cutting_ ? &report.cutting : nullptr, port_ ? &report.port : nullptr);
  for (std::size_t s = 0; s < stage_us_.size(); ++s) {
    const double us = static_cast<double>(report.stage_us[s]);
    stage_us_[s] = timed_ ? stage_us_[s] + 0.01 * (us - stage_us_[s]) : us;
  }
  timed_ = true;
}

void FrameHistory::add(const TickRecord& record, const CuttingRecord* cutting,
                       const PortRecord* port) {
  latest_ = record;
  measures_.add(record, port);
  if (port) given_out_J_ = port->given_out_J;
  const double speed_rad_per_s = cutting ? cutting->spindle_rad_per_s : set_speed_rad_per_s_;
  if (sags_ && cutting) {
    latest_spindle_rad_per_s_ = cutting->spindle_rad_per_s;
    spindle_krpm_.push_back(
        static_cast<float>(1e-3 * cutting->spindle_rad_per_s / kRevolutionPerMinute));
  }
  if (progress_ && progress_->has_pulp()) {
    const double wall_m = progress_->wall_over_pulp_m().value_or(std::nan(""));
    pulp_mm_.push_back(static_cast<float>(wall_m / kMillimetre));
  }
  turn_rad_ = std::fmod(turn_rad_ + speed_rad_per_s * dt_s_, 2.0 * std::numbers::pi);
  // Twice the window is kept, so that the front is cut off once in a window and not every tick.
  if (force_N_.size() >= 2 * window_) {
    for (auto* values : {&force_N_, &torque_mNm_, &tick_us_, &spindle_krpm_, &pulp_mm_}) {
      if (values->size() < 2 * window_) continue;  // is not kept
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
  state.world_from_tool = pose_of(latest_.tool_position_m, latest_.tool_orientation);
  state.burr_turn_rad = turn_rad_;
  for (int a = 0; a < 3; ++a) {
    state.force_N[a] = latest_.force_N[a];
    state.torque_Nm[a] = latest_.torque_Nm[a];
  }
  state.contacts = latest_.contacts;
  state.tick_us = latest_.step_us;
  if (progress_) state.removed_mm3 = progress_->removed_volume() * voxel_mm3_;
  state.outcome = outcome();
  for (std::size_t s = 0; timed_ && s < stage_us_.size(); ++s) {
    if (Stage(s) == Stage::kRemoval && !cutting_) continue;  // was not there
    state.stages.push_back({kShownStages[s], stage_us_[s]});
  }
  state.force_history_N = last(force_N_);
  state.torque_history_mNm = last(torque_mNm_);
  state.tick_history_us = last(tick_us_);
  state.spindle_history_krpm = last(spindle_krpm_);
  state.pulp_history_mm = last(pulp_mm_);
  return state;
}

}  // namespace sulcus
