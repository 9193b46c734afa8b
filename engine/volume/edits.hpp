#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

#include "engine/volume/edit.hpp"
#include "engine/volume/voxel_model.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

// What is done with edits beside the haptic thread. It takes memory at times: not for a tick.

/// How many leaves more a map that is full is given room for.
inline std::uint32_t more_leaves(const FillMap& fills) {
  return std::max<std::uint32_t>(64, static_cast<std::uint32_t>(fills.pages().size()) / 2);
}

/// Gives a solid voxel that level, above 0.
inline void set_level(VoxelModel& model, const Cell& c, FillLevel level) {
  if (model.set_level(c, level)) return;
  model.fills->reserve(more_leaves(*model.fills));
  (void)model.set_level(c, level);
}
inline void set_level(Workpiece& solid, const Cell& c, FillLevel level) {
  if (solid.set_level(c, level)) return;
  solid.reserve_fills(more_leaves(*solid.model().fills));
  (void)solid.set_level(c, level);
}

/// Makes an edit in its body, of a voxel that is solid there.
inline void apply_edit(const Edit& edit, VoxelModel& model) {
  const Cell c = model.grid.cell_of_linear(edit.voxel);
  edit.is_gone() ? void(model.set_level(c, 0)) : set_level(model, c, edit.level);
}
inline void apply_edit(const Edit& edit, Workpiece& solid) {
  const Cell c = solid.grid().cell_of_linear(edit.voxel);
  edit.is_gone() ? solid.remove(c) : set_level(solid, c, edit.level);
}

/// Takes the last edit of a voxel back, which had that level `before`.
inline void take_back_edit(const Edit& edit, FillLevel before, VoxelModel& model) {
  set_level(model, model.grid.cell_of_linear(edit.voxel), before);
}
inline void take_back_edit(const Edit& edit, FillLevel before, Workpiece& solid) {
  const Cell c = solid.grid().cell_of_linear(edit.voxel);
  edit.is_gone() ? solid.put_back(c, before) : set_level(solid, c, before);
}

/// Edits of some ticks as they are gone through: of each tick first those that lowered a level,
/// then those by which a voxel went. Both are rising by tick. A tick may have made them in another
/// order, which comes to the same: of a voxel that is gone nothing is lowered.
inline std::vector<Edit> in_order(std::vector<Edit> lowered, std::vector<Edit> gone) {
  if (lowered.empty()) return gone;
  std::vector<Edit> all;
  all.reserve(lowered.size() + gone.size());
  std::ranges::merge(lowered, gone, std::back_inserter(all), {}, &Edit::tick, &Edit::tick);
  return all;
}

}  // namespace sulcus
