#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "engine/normals/height_tile.hpp"
#include "engine/normals/map_space.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// The tiles of the leaf that the queries have come to, made when asked for and only where enough
/// queries follow in the leaf to pay for them. Queries of a leaf should come together; no result
/// depends on it.
class LeafTiles {
 public:
  LeafTiles(const Workpiece& workpiece, std::span<const VoxelQuery> queries, int neighbourhood,
            bool wants_even_rings)
      : workpiece_(workpiece),
        queries_(queries),
        ns_(neighbourhood),
        wants_even_rings_(wants_even_rings) {}

  /// Comes to a query. Returns how many from there on, up to `most`, can be taken together: those
  /// of its leaf (and, where queries do not come by leaves, others between them, which have no
  /// tile: is_of_leaf), or of leaves without tiles.
  std::size_t come_to(std::size_t query, std::size_t most) noexcept;
  /// The tile for maps along an axis of what was come to; null where there is none. Valid until
  /// another leaf is come to.
  const HeightTile* find(const MapAxes& axes) noexcept {
    if (!worthwhile_) return nullptr;
    const auto number = static_cast<std::size_t>(2 * axes.axis + (axes.sign > 0 ? 1 : 0));
    if (!made_[number]) {
      made_[number] = true;
      make(axes, tiles_[number]);
    }
    return &tiles_[number];
  }
  /// The leaf's first voxel.
  const Cell& origin() const { return origin_; }
  bool is_of_leaf(std::size_t query) const noexcept {
    const Cell& c = queries_[query].voxel;
    const int apart = (c.x() ^ origin_.x()) | (c.y() ^ origin_.y()) | (c.z() ^ origin_.z());
    return (apart & -kLeafEdge) == 0;
  }

 private:
  void enter(std::size_t query) noexcept;
  void make(const MapAxes& axes, HeightTile& tile) noexcept;

  static constexpr std::size_t kWorthwhile = 6;  // queries in a leaf

  const Workpiece& workpiece_;
  std::span<const VoxelQuery> queries_;
  int ns_;
  bool wants_even_rings_;
  Cell origin_ = Cell::Constant(-1);  // first voxel of the leaf
  bool worthwhile_ = false;
  std::array<bool, 6> made_{};  // by axis and sign
  std::array<HeightTile, 6> tiles_;
};

/// A voxel's place in its leaf, in the coordinates of a tile.
inline Eigen::Vector3i in_tile(const Cell& voxel, const MapAxes& axes) {
  return {voxel[axes.first()] & (kLeafEdge - 1), voxel[axes.second()] & (kLeafEdge - 1),
          voxel[axes.axis] & (kLeafEdge - 1)};
}

}  // namespace sulcus
