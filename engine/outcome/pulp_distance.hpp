#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/outcome/voxel_set.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

/// How near what is removed comes to the pulp, kept up voxel by voxel: a look-up for each, without
/// a search. Exact distances, from centre to centre, to the pulp as it was at the start. They are
/// found for all voxels of a leaf at a time, where the leaf's middle tells that one of them may be
/// the nearest so far, and kept: so the memory goes with what is cut near the pulp. Used by one
/// thread.
class PulpDistance {
 public:
  /// `pulp` has a voxel, and is not kept.
  explicit PulpDistance(const VoxelSet& pulp);

  void remove(const Cell& c);
  /// The least over all removed voxels, squared, in voxels; none before the first.
  std::optional<std::uint32_t> least_squared() const { return least_; }

  std::size_t memory_bytes() const;

 private:
  // Places of a leaf's block.
  static constexpr std::uint32_t kUnknown = ~std::uint32_t{0};
  static constexpr std::uint32_t kTooFar = kUnknown - 1;  // none of it is nearer than the least

  /// Squared distances of a leaf's voxels by their places, voxels. Whole numbers below 2^24, so
  /// that float is exact, which any processor adds and compares several at a time.
  using Block = std::array<float, kLeafEdge * kLeafEdge * kLeafEdge>;

  float squared_steps(std::size_t column, int z) const;
  const std::vector<float>& layer(int leaf_z);
  float squared_distance(const Cell& c);
  bool may_be_nearest(std::uint32_t leaf, double& middle);
  void fill(std::uint32_t leaf, double furthest, Block& block);

  VoxelGrid grid_;
  Cell low_, size_;  // the box of the pulp
  std::size_t words_;
  std::vector<std::uint64_t> columns_;  // the pulp's voxels in its box along z, by x, then y
  // By z in leaves: squared steps along z to the nearest voxel of the pulp in the same column, by
  // column, then z; empty where they were not asked for.
  std::vector<std::vector<float>> layers_;
  std::vector<std::uint32_t> place_;  // of each leaf's block
  std::vector<Block> blocks_;
  std::vector<float> row_;
  std::optional<std::uint32_t> least_;
};

}  // namespace sulcus
