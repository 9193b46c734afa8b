#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/zeroed_array.hpp"
#include "engine/volume/grid.hpp"
#include "engine/volume/leaf_bits.hpp"

namespace sulcus {

/// Labels of the 512 voxels of a leaf, x fastest.
using LabelBlock = std::array<std::uint8_t, 512>;

/// Tissue of every voxel, sparse: one label for a uniform leaf, 512 for a mixed one. Built once by
/// an importer (different leaves may be set from different threads), then only read.
class TissueMap {
 public:
  explicit TissueMap(std::uint32_t leaf_count) : uniform_(leaf_count, 0), mixed_(leaf_count) {}
  ~TissueMap();
  TissueMap(const TissueMap&) = delete;
  TissueMap& operator=(const TissueMap&) = delete;

  std::uint8_t label(std::uint32_t leaf, const Cell& c) const {
    const LabelBlock* block = mixed_[leaf].labels;
    return block ? (*block)[leaf_place(c)] : uniform_[leaf];
  }
  void set_uniform(std::uint32_t leaf, std::uint8_t label);
  /// Takes the labels of a leaf; stored as one label where they agree on its solid voxels.
  void set_block(std::uint32_t leaf, const LabelBlock& labels, const LeafBits& solid);

  std::uint32_t leaf_count() const { return static_cast<std::uint32_t>(uniform_.size()); }
  /// Null where the leaf is uniform.
  const LabelBlock* block(std::uint32_t leaf) const { return mixed_[leaf].labels; }
  std::uint8_t uniform_label(std::uint32_t leaf) const { return uniform_[leaf]; }
  /// Asks for what the two above read.
  void prefetch(std::uint32_t leaf) const {
    __builtin_prefetch(&uniform_[leaf]);
    __builtin_prefetch(&mixed_[leaf]);
  }
  /// One more than the largest label, of empty voxels too.
  int label_count() const;
  std::size_t memory_bytes() const;

 private:
  struct MixedLeaf {
    LabelBlock* labels;  // owned; null, and mostly no memory, where the leaf is uniform
  };

  std::vector<std::uint8_t> uniform_;
  ZeroedArray<MixedLeaf> mixed_;
};

}  // namespace sulcus
