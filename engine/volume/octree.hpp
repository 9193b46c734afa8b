#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Child node status (CNS) of [Kim and Park 2019, III-A]. The children of a leaf are its voxels.
enum class ChildStatus : std::uint8_t { kNone = 0, kFull = 1, kSome = 2 };

/// A node's bounds are those of the solid voxels below it when the tree was built, in voxels,
/// `upper` exclusive. Removal only ever shrinks the solid, so they stay conservative.
struct OctreeNode {
  std::array<std::uint16_t, 3> lower{}, upper{};
  ChildStatus status = ChildStatus::kNone;
};

/// The paper's pointerless linear octree [III-A]: all nodes in one array, each level contiguous,
/// level 0 the root and the last the leaves of 8x8x8 voxels. A level is a grid, x fastest; the
/// children of (x, y, z) are (2x + a, 2y + b, 2z + c). Where the paper's tree is a cube of 2^n
/// leaves, ours takes any grid: children beyond it do not exist and are no children.
class Octree {
 public:
  /// A node by level and place.
  struct Place {
    int level = 0;
    Eigen::Vector3i at = Eigen::Vector3i::Zero();
  };

  Octree() = default;
  /// Runs on oneTBB.
  explicit Octree(const VoxelModel& model);

  int levels() const { return static_cast<int>(dims_.size()); }
  const Eigen::Vector3i& dims(int level) const { return dims_[level]; }
  std::uint32_t index(const Place& p) const {
    const Eigen::Vector3i& n = dims_[p.level];
    return begin_[p.level] +
           static_cast<std::uint32_t>(p.at.x() + n.x() * (p.at.y() + n.y() * p.at.z()));
  }
  const OctreeNode& node(std::uint32_t i) const { return nodes_[i]; }
  /// Number of a leaf, as in VoxelGrid, from its place at the last level.
  std::uint32_t leaf_number(std::uint32_t node) const { return node - begin_.back(); }
  bool is_leaf_level(int level) const { return level + 1 == levels(); }

  /// What an edit does at once: the leaf's own status. Parents follow by lazy evaluation.
  void set_leaf_status(std::uint32_t leaf, ChildStatus status) noexcept {
    nodes_[begin_.back() + leaf].status = status;
  }
  /// Lazy evaluation [III-B]: a traversal that finds an internal node without children left notes
  /// it; the tick switches the noted ones off after the contact, so that evaluating a contact
  /// changes nothing. A parent is found in a later tick, once its children are off.
  void switch_off(std::span<const std::uint32_t> nodes) noexcept {
    for (std::uint32_t i : nodes) nodes_[i].status = ChildStatus::kNone;
  }
  /// A leaf, by its place at the last level, that has a voxel again, and the nodes over it: there
  /// as they were when the tree was built.
  void switch_on(Eigen::Vector3i leaf, ChildStatus status) noexcept {
    for (int level = levels() - 1; level >= 0; --level, leaf /= 2) {
      nodes_[index({level, leaf})].status = is_leaf_level(level) ? status : ChildStatus::kSome;
    }
  }
  std::size_t memory_bytes() const { return nodes_.capacity() * sizeof(OctreeNode); }

 private:
  /// Makes the nodes of a slice of a level from those of the next.
  void join_children(int level, int z);

  std::vector<OctreeNode> nodes_;
  std::vector<std::uint32_t> begin_;   // first node of each level
  std::vector<Eigen::Vector3i> dims_;  // nodes along each axis, by level
};

}  // namespace sulcus
