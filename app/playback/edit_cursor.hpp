#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/recording/recording_reader.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The edits of a recording up to and with a row, of all bodies, in the order of `in_order`.
std::vector<Edit> recorded_edits(const RecordingReader& reader, std::size_t row);

/// The edits of a recording, and how many of them a shape has seen: any time of it is reached by
/// going on or back from where it is.
class EditCursor {
 public:
  /// `start`: bodies before the first row, the workpiece first; those that nobody follows may be
  /// left out at the end. They are not kept. InputError where an edit lowers a level of theirs to
  /// what it is or above.
  EditCursor(const RecordingReader& reader, std::span<const VoxelModel* const> start);

  std::span<const Edit> edits() const { return edits_; }
  std::uint64_t at() const { return at_; }
  /// How many there are up to and with a row's tick.
  std::uint64_t end_of_row(std::size_t row) const { return ends_[row]; }
  /// Those from `first` to before `end`, as far as there are.
  std::span<const Edit> between(std::uint64_t first, std::uint64_t end) const {
    const auto last = std::min<std::uint64_t>(end, edits_.size());
    return std::span(edits_).subspan(std::min(first, last), last - std::min(first, last));
  }

  /// To where the first `end` of them have been made: `apply(edit)` each on the way on,
  /// `take_back(edit, level of its voxel before)` each on the way back, the latest first.
  template <class Apply, class TakeBack>
  void seek(std::uint64_t end, const Apply& apply, const TakeBack& take_back) {
    end = std::min<std::uint64_t>(end, edits_.size());
    for (; at_ < end; ++at_) apply(edits_[at_]);
    for (; at_ > end; --at_) take_back(edits_[at_ - 1], level_before(at_ - 1));
  }
  /// The level that the voxel of an edit, by its number, had before it.
  FillLevel level_before(std::uint64_t edit) const {
    return levels_before_.empty() ? kFullLevel : levels_before_[edit];
  }
  /// The shape has seen them otherwise: a tick made them again.
  void pass(std::uint64_t end) { at_ = end; }

 private:
  std::vector<Edit> edits_;
  std::vector<FillLevel> levels_before_;  // of each edit's voxel; none where all bodies are binary
  std::vector<std::uint64_t> ends_;       // of each row
  std::uint64_t at_ = 0;
};

}  // namespace sulcus
