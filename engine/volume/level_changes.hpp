#pragma once

#include <cstddef>
#include <optional>

#include "engine/volume/edits.hpp"

namespace sulcus {

/// Follows the fill levels of a body from edit to edit: so each is known with the level that its
/// voxel had before. Of a binary body it holds nothing. Used by one thread.
class LevelChanges {
 public:
  /// `start` is not kept.
  explicit LevelChanges(const VoxelModel& start) : grid_(start.grid), fills_(start.fills) {}

  /// Before an edit of a solid voxel of the body; the next call sees what it left.
  FillLevel before(const Edit& edit) {
    if (!fills_) return kFullLevel;
    const Cell c = grid_.cell_of_linear(edit.voxel);
    const std::uint32_t leaf = grid_.leaf_of(c);
    const FillLevel level = fills_->level(leaf, leaf_place(c));
    if (!fills_->has_room()) fills_->reserve(more_leaves(*fills_));
    fills_->set(leaf, leaf_place(c), edit.level, kAllSolid);
    return level;
  }
  std::size_t memory_bytes() const { return fills_ ? fills_->memory_bytes() : 0; }

 private:
  // No other voxels of a new page are asked for.
  static constexpr LeafBits kAllSolid = [] {
    LeafBits bits;
    bits.words.fill(~std::uint64_t{0});
    return bits;
  }();

  VoxelGrid grid_;
  std::optional<FillMap> fills_;
};

}  // namespace sulcus
