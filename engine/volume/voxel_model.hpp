#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/volume/grid.hpp"
#include "engine/volume/leaf_bits.hpp"
#include "engine/volume/tissue_map.hpp"

namespace sulcus {

/// What importers make, recordings keep and renderers copy: which voxels are solid, and the tissue
/// of each. The tissues never change, so copies share them.
struct VoxelModel {
  VoxelGrid grid;
  std::vector<LeafBits> leaves;              // grid.leaf_count(), x fastest
  std::shared_ptr<const TissueMap> tissues;  // null: one tissue, no labels
  bool clipped = false;                      // the solid reached beyond the grid

  bool solid(const Cell& c) const {
    return grid.contains(c) && leaves[grid.leaf_of(c)].has(leaf_place(c));
  }
  void set(const Cell& c, bool value) {
    LeafBits& leaf = leaves[grid.leaf_of(c)];
    value ? leaf.set(leaf_place(c)) : leaf.reset(leaf_place(c));
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
