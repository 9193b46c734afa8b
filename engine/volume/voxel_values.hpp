#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "engine/volume/grid.hpp"

namespace sulcus {

/// A quantity of some voxels of a grid, kept by leaf: 2 KiB for each leaf that has any. SI units.
/// Used by one thread at a time; reading by several.
class VoxelValues {
 public:
  static constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  /// Of a leaf, by leaf_place; kNone where a voxel has none.
  using Block = std::array<float, 512>;

  explicit VoxelValues(const VoxelGrid& grid) : grid_(grid) {}

  /// `c` lies in the grid.
  float& operator[](const Cell& c) {
    const auto [block, is_new] = blocks_.try_emplace(grid_.leaf_of(c));
    if (is_new) block->second.fill(kNone);
    return block->second[leaf_place(c)];
  }
  void set_block(std::uint32_t leaf, const Block& values) { blocks_[leaf] = values; }
  /// kNone where there is none, also beyond the grid.
  float at(const Cell& c) const {
    if (!grid_.contains(c)) return kNone;
    const auto block = blocks_.find(grid_.leaf_of(c));
    return block == blocks_.end() ? kNone : block->second[leaf_place(c)];
  }
  const std::unordered_map<std::uint32_t, Block>& blocks() const { return blocks_; }
  const VoxelGrid& grid() const { return grid_; }

 private:
  VoxelGrid grid_;
  std::unordered_map<std::uint32_t, Block> blocks_;
};

}  // namespace sulcus
