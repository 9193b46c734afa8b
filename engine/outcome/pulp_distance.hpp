#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "engine/outcome/voxel_distance.hpp"
#include "engine/outcome/voxel_set.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

/// How near what is removed comes to the pulp, kept up voxel by voxel: exact distances, from centre
/// to centre, to the pulp as it was at the start. A voxel is asked only whether any of the pulp is
/// nearer to it than to all before, which few parts of the pulp can be. And the distances of two
/// voxels differ by no more than what lies between the two, so one question often answers for the
/// eight voxels about one another, or for a leaf. Used by one thread.
class PulpDistance {
 public:
  /// `pulp` has a voxel.
  explicit PulpDistance(VoxelSet pulp);

  void remove(const Cell& c);
  /// The least over all removed voxels, squared, in voxels; none before the first.
  std::optional<std::uint32_t> least_squared() const { return least_; }

  const VoxelSet& pulp() const { return pulp_; }
  std::size_t memory_bytes() const;

 private:
  // Places of a leaf's bounds.
  static constexpr std::uint32_t kUnknown = ~std::uint32_t{0};
  static constexpr std::uint32_t kTooFar = kUnknown - 1;  // none of it is nearer than the nearest

  /// Of a leaf's parts: none of their voxels is nearer to the pulp, voxels. 0: not asked yet.
  struct Bounds {
    std::array<float, 8> of_4{};   // 4 x 4 x 4 voxels
    std::array<float, 64> of_2{};  // 2 x 2 x 2
  };

  std::optional<std::uint32_t> squared_distance(const Cell& c, float more);
  bool may_be_nearest(const Cell& middle, float from_middle, float& bound);

  VoxelSet pulp_;
  LeafTree tree_;
  std::vector<std::uint32_t> place_;  // of each leaf of the grid
  std::vector<Bounds> bounds_;
  // Leaves of the pulp with all of its voxels within `reach_` of a place: of all questions nearby.
  std::vector<LeafTree::Near> leaves_nearby_;
  Cell nearby_ = Cell::Zero();
  float reach_ = -1.0f;
  float nearest_ = std::numeric_limits<float>::infinity();  // of all removed voxels, voxels
  std::optional<std::uint32_t> least_;                      // the same, squared
};

}  // namespace sulcus
