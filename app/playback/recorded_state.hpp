#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/playback/recorded_run.hpp"

namespace sulcus {

/// A recording at any of its ticks: the shapes of its bodies and all that a later tick depends on.
/// It goes there from the nearest state that was recorded, and runs the ticks after that again.
class RecordedState {
 public:
  /// At the start. `run` outlives it, and its simulation is moved by it.
  explicit RecordedState(RecordedRun& run);

  /// To right after a row's tick, on or back. InputError where no intact state leads there, or the
  /// ticks that do come out otherwise than they were recorded.
  void seek_row(std::size_t row);
  /// Runs the next row's tick and returns what came out, to be compared. `loose`: the voxels that
  /// leave in it; without, those that were recorded.
  TickRecord step(std::optional<std::span<const std::uint32_t>> loose = {});
  /// The same, of what was recorded; InputError where other voxels go than did.
  TickRecord step_as_recorded();
  /// Rows that have been run: the next is this one.
  std::size_t next_row() const { return next_; }
  /// Whether the next row can be run: it follows on the one before it.
  bool follows() const;
  const Simulation& simulation() const { return *run_.simulation; }
  /// Whether the edits of the last step are those that were recorded; where not, nothing else can
  /// be asked of it.
  bool same_edits() const { return same_edits_; }

 private:
  bool go_to(const KeyframeInfo& info, std::size_t row);
  void go_to_start();
  void move_shapes(std::uint64_t edits_end);

  RecordedRun& run_;
  EditCursor edits_;
  std::vector<std::byte> start_;  // the state before the first row
  std::size_t next_ = 0;
  bool same_edits_ = true;
  std::vector<std::uint32_t> loose_;
  std::vector<Edit> made_;  // by the last step, in the recording's order
};

}  // namespace sulcus
