#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace sulcus {

/// Index of a voxel, (i, j, k).
using Cell = Eigen::Vector3i;

/// Cells along one axis, and in all: what the pinned recording and the 32-bit voxel keys can hold.
inline constexpr int kMaxCellsPerAxis = 1024;
/// Edge of a leaf of the octree, in voxels. Cells are multiples of it.
inline constexpr int kLeafEdge = 8;

/// The paper's 32-bit voxel key: i, j and k in 10 bits each [Kim and Park 2019, III-A].
constexpr std::uint32_t voxel_key(int i, int j, int k) {
  return static_cast<std::uint32_t>(i) | static_cast<std::uint32_t>(j) << 10 |
         static_cast<std::uint32_t>(k) << 20;
}
inline std::uint32_t voxel_key(const Cell& c) { return voxel_key(c.x(), c.y(), c.z()); }
inline Cell cell_of_key(std::uint32_t key) {
  return {static_cast<int>(key & 1023u), static_cast<int>(key >> 10 & 1023u),
          static_cast<int>(key >> 20 & 1023u)};
}

/// Key of the first voxel of a voxel's leaf.
constexpr std::uint32_t leaf_key(std::uint32_t key) {
  return key & ~voxel_key(kLeafEdge - 1, kLeafEdge - 1, kLeafEdge - 1);
}
/// Place of a voxel in its leaf, 0 to 511, x fastest.
constexpr int leaf_place(std::uint32_t key) {
  return static_cast<int>((key & 7u) | (key >> 10 & 7u) << 3 | (key >> 20 & 7u) << 6);
}
inline int leaf_place(const Cell& c) { return (c.x() & 7) | (c.y() & 7) << 3 | (c.z() & 7) << 6; }
/// Whether `test(cell)` holds for a cell from `begin` to before `end`, asked x fastest until it
/// does.
template <class Test>
bool any_cell(const Cell& begin, const Cell& end, const Test& test) {
  for (int z = begin.z(); z < end.z(); ++z) {
    for (int y = begin.y(); y < end.y(); ++y) {
      for (int x = begin.x(); x < end.x(); ++x) {
        if (test(Cell(x, y, z))) return true;
      }
    }
  }
  return false;
}
/// Calls `visit(cell)` for the cells from `begin` to before `end`, x fastest.
template <class Visit>
void for_each_cell(const Cell& begin, const Cell& end, const Visit& visit) {
  for (int z = begin.z(); z < end.z(); ++z) {
    for (int y = begin.y(); y < end.y(); ++y) {
      for (int x = begin.x(); x < end.x(); ++x) visit(Cell(x, y, z));
    }
  }
}

/// The voxel of a place, from the first of its leaf.
inline Cell cell_in_leaf(int place) { return {place & 7, place >> 3 & 7, place >> 6}; }

/// A grid of cubic voxels whose centre is the origin of the scene. Two spaces: `world` in metres
/// (the scene's), `index` in voxels, where the centre of voxel (i, j, k) is at (i, j, k).
struct VoxelGrid {
  Eigen::Vector3i cells = Eigen::Vector3i::Zero();  // multiples of 8, at most 1024 each
  double voxel_m = 0.0;

  Eigen::Vector3d world_from_index(const Eigen::Vector3d& p_index) const {
    return (p_index - origin_index()) * voxel_m;
  }
  Eigen::Vector3d index_from_world(const Eigen::Vector3d& p_world) const {
    return p_world / voxel_m + origin_index();
  }
  Eigen::Vector3d centre_world(const Cell& c) const { return world_from_index(c.cast<double>()); }
  /// The scene's origin in index space.
  Eigen::Vector3d origin_index() const {
    return 0.5 * (cells.cast<double>() - Eigen::Vector3d::Ones());
  }
  bool contains(const Cell& c) const {
    return (c.array() >= 0).all() && (c.array() < cells.array()).all();
  }
  /// x + y nx + z nx ny: how files name a voxel.
  std::uint32_t linear(const Cell& c) const {
    return static_cast<std::uint32_t>(c.x() + cells.x() * (c.y() + cells.y() * c.z()));
  }
  Cell cell_of_linear(std::uint32_t v) const {
    const auto nx = static_cast<std::uint32_t>(cells.x());
    const auto ny = static_cast<std::uint32_t>(cells.y());
    return {static_cast<int>(v % nx), static_cast<int>(v / nx % ny), static_cast<int>(v / nx / ny)};
  }
  std::uint64_t cell_count() const {
    return static_cast<std::uint64_t>(cells.x()) * cells.y() * cells.z();
  }
  double voxel_volume_m3() const { return voxel_m * voxel_m * voxel_m; }

  // Leaves of 8x8x8 voxels, x fastest.
  Eigen::Vector3i leaf_dims() const { return cells / kLeafEdge; }
  std::uint32_t leaf_count() const {
    return static_cast<std::uint32_t>(cell_count() / (kLeafEdge * kLeafEdge * kLeafEdge));
  }
  std::uint32_t leaf_of(const Cell& c) const {
    const Eigen::Vector3i n = leaf_dims();
    return static_cast<std::uint32_t>((c.x() >> 3) + n.x() * ((c.y() >> 3) + n.y() * (c.z() >> 3)));
  }
  /// First voxel of a leaf.
  Cell leaf_origin(std::uint32_t leaf) const {
    const Eigen::Vector3i n = leaf_dims();
    const int l = static_cast<int>(leaf);
    return Cell(l % n.x(), l / n.x() % n.y(), l / n.x() / n.y()) * kLeafEdge;
  }
};

}  // namespace sulcus
