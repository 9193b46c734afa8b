#include "app/window/rewind_film.hpp"

#include <algorithm>

namespace sulcus {

RewindFilm::RewindFilm(std::span<const RenderedBody> bodies) {
  levels_.reserve(bodies.size());
  for (const RenderedBody& body : bodies) levels_.emplace_back(body.model);
}

void RewindFilm::add(const TickReport& report, std::span<const Edit> edits) {
  constexpr std::uint64_t kEvery = 20;
  const TickRecord& record = report.record;
  for (const Edit& edit : edits) {
    before_.push_back(levels_[edit.body].before(edit));
    edits_.push_back(edit);
  }
  if (!moments_.empty() && record.tick % kEvery != 0) return;
  moments_.push_back({record.time_s, record.tick, edits_.size(),
                      pose_of(record.tool_position_m, record.tool_orientation),
                      pose_of(record.device_position_m, record.device_orientation)});
}

/// The last that is not later, or the first.
const RewindFilm::Moment& RewindFilm::moment_at(double time_s) const {
  const auto after = std::ranges::upper_bound(moments_, time_s, {}, &Moment::time_s);
  return after == moments_.begin() ? *after : *(after - 1);
}

void RewindFilm::describe(const Moment& moment, FrameState& state) {
  state.time_s = moment.time_s;
  state.tick = moment.tick;
  state.world_from_tool = moment.tool;
  if (state.device) state.device = moment.device;
  state.force_N.setZero();
  state.torque_Nm.setZero();
  state.contact_marks = {};
}

/// Back: the latest edit first, so that the earliest level of a voxel is the last to be set.
RewindFilm::Change RewindFilm::change_to(std::size_t edits_end) const {
  Change change;
  change.voxels.resize(levels_.size());
  change.levels.resize(levels_.size());
  const std::size_t drawn = drawn_.value_or(edits_.size());
  for (std::size_t i = drawn; i > edits_end; --i) {
    const Edit& edit = edits_[i - 1];
    if (edit.is_gone()) {
      change.voxels[edit.body].push_back(edit.voxel);
    } else {
      change.levels[edit.body].push_back({edit.voxel, before_[i - 1]});
    }
  }
  for (std::size_t i = drawn; i < edits_end; ++i) {
    const Edit& edit = edits_[i];
    if (edit.is_gone()) {
      change.voxels[edit.body].push_back(edit.voxel);
    } else {
      change.levels[edit.body].push_back({edit.voxel, edit.level});
    }
  }
  return change;
}

}  // namespace sulcus
