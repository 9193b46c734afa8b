#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "engine/core/zeroed_array.hpp"
#include "engine/volume/fill_map.hpp"
#include "engine/volume/grid.hpp"
#include "engine/volume/leaf_bits.hpp"
#include "engine/volume/tissue_map.hpp"

namespace sulcus {

/// What importers make, recordings keep and renderers copy: which voxels are solid, how much of
/// each is filled, and its tissue. The tissues never change, so copies share them.
struct VoxelModel {
  VoxelGrid grid;
  ZeroedArray<LeafBits> leaves;              // grid.leaf_count(), x fastest
  std::shared_ptr<const TissueMap> tissues;  // null: one tissue, no labels
  std::optional<FillMap> fills = {};         // none: binary, every solid voxel is full
  bool clipped = false;                      // the solid reached beyond the grid

  bool solid(const Cell& c) const {
    return grid.contains(c) && leaves[grid.leaf_of(c)].has(leaf_place(c));
  }
  void set(const Cell& c, bool value) {
    LeafBits& leaf = leaves[grid.leaf_of(c)];
    value ? leaf.set(leaf_place(c)) : leaf.reset(leaf_place(c));
  }
  /// 0 of an empty voxel, also outside the grid.
  FillLevel level(const Cell& c) const {
    if (!solid(c)) return 0;
    return fills ? fills->level(grid.leaf_of(c), leaf_place(c)) : kFullLevel;
  }
  /// Fills a voxel of the grid up to a level, or empties it: of a binary model only wholly. False,
  /// and nothing is done, where `fills` has no room for it.
  bool set_level(const Cell& c, FillLevel level) {
    const std::uint32_t leaf = grid.leaf_of(c);
    const int place = leaf_place(c);
    if (fills) {
      if (level % kFullLevel != 0 && !fills->page(leaf) && !fills->has_room()) return false;
      if (level != 0 || fills->page(leaf)) fills->set(leaf, place, level, leaves[leaf]);
    }
    set(c, level != 0);
    return true;
  }
  /// Label of a voxel: an index into the scene's tissues; 0 where there is one tissue only.
  std::uint8_t tissue(const Cell& c) const {
    return tissues ? tissues->label(grid.leaf_of(c), c) : std::uint8_t{0};
  }
  std::uint64_t solid_count() const {
    std::uint64_t count = 0;
    for (const LeafBits& leaf : leaves) count += static_cast<std::uint64_t>(count_voxels(leaf));
    return count;
  }
};

}  // namespace sulcus
