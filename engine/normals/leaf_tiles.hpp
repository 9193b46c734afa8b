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

  /// The tile for the map of a query along an axis; null where there is none. Valid until a query
  /// of another leaf is asked for.
  const HeightTile* find(std::size_t query, const MapAxes& axes) noexcept {
    if (!is_of_leaf(queries_[query].voxel)) enter(query);
    if (!worthwhile_) return nullptr;
    const auto place = static_cast<std::size_t>(2 * axes.axis + (axes.sign > 0 ? 1 : 0));
    if (!made_[place]) {
      made_[place] = true;
      make(axes, tiles_[place]);
    }
    return &tiles_[place];
  }

  /// Whether a voxel is of the leaf that the last query was asked for in.
  bool is_of_leaf(const Cell& c) const noexcept {
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
