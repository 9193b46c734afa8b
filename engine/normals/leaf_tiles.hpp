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

/// The tiles of the leaf that the queries have reached, made when asked for and only where enough
/// queries follow in the leaf to pay for them. Queries of a leaf should come together; no result
/// depends on it.
class LeafTiles {
 public:
  LeafTiles(const Workpiece& workpiece, std::span<const VoxelQuery> queries, int neighbourhood,
            FitWindow window)
      : workpiece_(workpiece), queries_(queries), ns_(neighbourhood), window_(window) {}

  /// Advances to a query. Returns how many from there on, up to `most`, can be taken together:
  /// those of its leaf (and, where queries do not come by leaves, others between them, which have
  /// no tile: is_of_leaf), or of leaves without tiles.
  std::size_t advance_to(std::size_t query, std::size_t most) noexcept;
  /// The tile for maps along an axis of the leaf that was reached; null where there is none. Valid
  /// until another leaf is reached.
  const HeightTile* find(const MapAxes& axes) noexcept {
    if (!use_tiles_) return nullptr;
    const std::size_t number = number_of(axes);
    if (!made_[number]) {
      made_[number] = true;
      make(axes, tiles_[number]);
    }
    return &tiles_[number];
  }
  /// As find, but null where it is not made yet: for a few voxels it does not pay.
  const HeightTile* find_made(const MapAxes& axes) const noexcept {
    const std::size_t number = number_of(axes);
    return use_tiles_ && made_[number] ? &tiles_[number] : nullptr;
  }
  /// The leaf's first voxel.
  const Cell& origin() const { return origin_; }
  bool is_of_leaf(std::size_t query) const noexcept {
    const Cell& c = queries_[query].voxel;
    const int apart = (c.x() ^ origin_.x()) | (c.y() ^ origin_.y()) | (c.z() ^ origin_.z());
    return (apart & -kLeafEdge) == 0;
  }

 private:
  static std::size_t number_of(const MapAxes& axes) {
    return static_cast<std::size_t>(2 * axes.axis + (axes.sign > 0 ? 1 : 0));
  }
  void enter(std::size_t query) noexcept;
  void make(const MapAxes& axes, HeightTile& tile) noexcept;

  const Workpiece& workpiece_;
  std::span<const VoxelQuery> queries_;
  int ns_;
  FitWindow window_;
  Cell origin_ = Cell::Constant(-1);  // first voxel of the leaf
  bool use_tiles_ = false;
  std::array<bool, 6> made_{};  // by axis and sign
  std::array<HeightTile, 6> tiles_;
};

}  // namespace sulcus
