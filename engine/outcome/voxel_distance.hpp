#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>

#include "engine/outcome/voxel_set.hpp"

namespace sulcus {

/// A tree of boxes over the leaves of a set (Eigen's KdBVH), which leads to the few in which the
/// voxel nearest to another can be: its memory goes with the leaves that hold voxels, not with the
/// grid. Lengths in voxels, from centre to centre. It keeps no voxels: the set is asked for them.
/// Any number of threads may ask at a time.
class LeafTree {
 public:
  explicit LeafTree(const VoxelSet& set);

  /// From `c`, which may lie in the set, to its nearest voxel; it is not empty.
  std::uint32_t squared_distance(const VoxelSet& set, const Cell& c) const;

  /// A leaf, and what none of its voxels is nearer than.
  struct Near {
    float distance = 0.0f;
    std::uint32_t leaf = 0;
    Cell first;  // its first voxel
  };
  /// Replaces `leaves` by those that may hold a voxel at most so far from `c`, the nearest first.
  void leaves_within(const Cell& c, float distance, std::vector<Near>& leaves) const;

 private:
  VoxelGrid grid_;
  Eigen::KdBVH<float, 3, std::uint32_t> tree_;
};

/// The lesser of `best` and the squared distance of `c` to the nearest voxel of a leaf that begins
/// at `first`.
int nearer_in_leaf(const Cell& c, const Cell& first, const LeafBits& voxels, int best);

/// Exact distances of the voxels of one set, each to the nearest of another of the same grid, from
/// centre to centre in voxels, as their squares, which are whole numbers: leaf by leaf in the order
/// of its leaves() and by their places in a leaf; empty where either set is. Runs on oneTBB.
std::vector<std::uint32_t> squared_distances(const VoxelSet& from, const VoxelSet& to);

}  // namespace sulcus
