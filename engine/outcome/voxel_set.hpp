#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Some voxels of a grid, kept by leaf: four bytes for every leaf of the grid, 72 more for one that
/// holds a voxel. Used by one thread at a time.
class VoxelSet {
 public:
  explicit VoxelSet(const VoxelGrid& grid) : grid_(grid), place_(grid.leaf_count(), kNone) {}

  /// False where it was in the set before. `c` lies in the grid.
  bool insert(const Cell& c);
  /// Adds the voxels of a leaf.
  void insert(std::uint32_t leaf, const LeafBits& voxels);

  /// Also asked of voxels beyond the grid, which are never in the set.
  bool contains(const Cell& c) const {
    return grid_.contains(c) && voxels(grid_.leaf_of(c)).has(leaf_place(c));
  }
  /// Of a leaf; none where the set has none of it.
  const LeafBits& voxels(std::uint32_t leaf) const {
    static constexpr LeafBits kEmpty{};
    return place_[leaf] == kNone ? kEmpty : blocks_[place_[leaf]];
  }
  /// The leaves with a voxel of the set, in the order in which they came to have one.
  std::span<const std::uint32_t> leaves() const { return leaves_; }
  std::uint64_t count() const { return count_; }
  const VoxelGrid& grid() const { return grid_; }
  std::size_t memory_bytes() const;

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  LeafBits& block(std::uint32_t leaf);

  VoxelGrid grid_;
  std::vector<std::uint32_t> place_;  // of each leaf's block
  std::vector<std::uint32_t> leaves_;
  std::vector<LeafBits> blocks_;  // beside leaves_
  std::uint64_t count_ = 0;
};

/// Voxels of a that are not in b; both of one grid.
VoxelSet without(const VoxelSet& a, const VoxelSet& b);

/// Solid voxels of a tissue.
VoxelSet voxels_of_tissue(const VoxelModel& model, std::uint8_t label);

/// The volume of solid voxels of a model, in voxels: with fractions by how much of each is filled.
double filled_volume(const VoxelSet& voxels, const VoxelModel& model);

}  // namespace sulcus
