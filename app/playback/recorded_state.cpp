#include "app/playback/recorded_state.hpp"

#include <algorithm>
#include <stdexcept>

#include "engine/core/error.hpp"

namespace sulcus {

namespace {

bool same_edit(const Edit& a, const Edit& b) {
  return a.tick == b.tick && a.voxel == b.voxel && a.body == b.body && a.cause == b.cause &&
         a.level == b.level;
}

EditCursor cursor_of(const RecordedRun& run) {
  std::vector<const VoxelModel*> start;
  for (const Body& body : run.simulation->state().bodies) start.push_back(&body.solid.model());
  return {run.reader, start};
}

}  // namespace

RecordedState::RecordedState(RecordedRun& run) : run_(run), edits_(cursor_of(run)) {
  save_state(run_.simulation->state(), start_);
  const auto is_loose = [](const Edit& edit) { return edit.cause == EditCause::kLoose; };
  if (!run_.simulation->scene().loose_pieces && std::ranges::any_of(edits_.edits(), is_loose)) {
    throw InputError(run_.path, "/edits", "a piece cut loose",
                     "none, as its scene has no [loose_pieces]");
  }
}

void RecordedState::move_shapes(std::uint64_t edits_end) {
  Simulation& simulation = *run_.simulation;
  edits_.seek(
      edits_end,
      [&](const Edit& edit) {
        if (!simulation.is_solid(edit)) {
          throw InputError(run_.path, "/edits", "a voxel removed that is not there", "a solid one");
        }
        simulation.apply(edit);
      },
      [&](const Edit& edit, FillLevel before) { simulation.take_back(edit, before); });
}

void RecordedState::go_to_start() {
  move_shapes(0);
  if (!run_.simulation->load_state(start_)) throw std::logic_error("a state that was just saved");
  next_ = 0;
}

bool RecordedState::go_to(const KeyframeInfo& info, std::size_t row) {
  const std::optional<std::vector<std::byte>> state = run_.reader.keyframe(info);
  if (!state) return false;
  move_shapes(edits_.end_of_row(row));
  if (!run_.simulation->load_state(*state) ||
      run_.simulation->state().tick != run_.rows[row].tick + 1) {
    go_to_start();  // what was loaded of it is no state
    return false;
  }
  next_ = row + 1;
  return true;
}

bool RecordedState::follows() const {
  return next_ < run_.rows.size() &&
         (next_ == 0 || run_.rows[next_].tick == run_.rows[next_ - 1].tick + 1);
}

TickRecord RecordedState::step(std::optional<std::span<const std::uint32_t>> loose) {
  const TickRecord& row = run_.rows[next_];
  const std::uint64_t end = edits_.end_of_row(next_);
  const auto recorded = edits_.between(edits_.at(), end);
  if (!loose) {
    loose_.clear();
    for (const Edit& edit : recorded) {
      if (edit.cause == EditCause::kLoose) loose_.push_back(edit.voxel);
    }
    loose_.resize(std::min(loose_.size(), kLeavePerTick));
    loose = loose_;
  }
  const std::optional<Pose>& pose = run_.poses[next_];
  PlaybackDevice device({&pose, 1}, row.tick, run_.pedal);
  const TickRecord again = run_.simulation->step(device, *loose);
  made_.assign(run_.simulation->edits().begin(), run_.simulation->edits().end());
  std::stable_partition(made_.begin(), made_.end(),
                        [](const Edit& edit) { return !edit.is_gone(); });
  same_edits_ = std::ranges::equal(made_, recorded, same_edit);
  // Where they differ, going back from here would not lead to the start.
  if (same_edits_) edits_.pass(end);
  ++next_;
  return again;
}

TickRecord RecordedState::step_as_recorded() {
  const TickRecord again = step();
  if (!same_edits_) {
    throw InputError(run_.path, "tick " + std::to_string(run_.rows[next_ - 1].tick),
                     "other voxels removed than were recorded",
                     "the build that recorded it, " + run_.reader.header().build);
  }
  return again;
}

void RecordedState::seek_row(std::size_t row) {
  const std::vector<TickRecord>& rows = run_.rows;
  const auto gap_before =
      std::ranges::find_if(run_.reader.gaps().rbegin(), run_.reader.gaps().rend(),
                           [&](const auto& gap) { return gap.end <= rows[row].tick; });
  const bool any_gap = gap_before != run_.reader.gaps().rend();
  const std::uint64_t earliest = any_gap ? gap_before->end : rows.front().tick;
  const auto is_here = [&] {
    return next_ > 0 && next_ <= row + 1 && rows[next_ - 1].tick >= earliest;
  };

  // The latest state from which it can be reached: a recorded one, where the shape is, or the
  // start.
  bool ready = false;
  const std::vector<KeyframeInfo>& keyframes = run_.reader.keyframes();
  for (auto k = keyframes.rbegin(); k != keyframes.rend() && !ready; ++k) {
    if (k->tick > rows[row].tick) continue;
    if (k->tick < earliest || (is_here() && k->tick < rows[next_ - 1].tick)) break;
    const auto at = std::ranges::lower_bound(rows, k->tick, {}, &TickRecord::tick);
    if (at == rows.end() || at->tick != k->tick) continue;
    ready = go_to(*k, static_cast<std::size_t>(at - rows.begin()));
  }
  if (!ready && !is_here()) {
    if (any_gap) {
      throw InputError(run_.path, "tick " + std::to_string(rows[row].tick),
                       "no intact state after rows that were not recorded",
                       "a time before tick " + std::to_string(gap_before->first));
    }
    go_to_start();
  }
  while (next_ <= row) step_as_recorded();
}

}  // namespace sulcus
