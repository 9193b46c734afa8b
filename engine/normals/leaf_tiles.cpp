#include "engine/normals/leaf_tiles.hpp"

#include <algorithm>

#include "engine/normals/map_kernels.hpp"

namespace sulcus {

std::size_t LeafTiles::advance_to(std::size_t query, std::size_t most) noexcept {
  if (!is_of_leaf(query)) enter(query);
  const std::size_t end = query + std::min(most, queries_.size() - query);
  std::size_t k = query + 1;
  if (use_tiles_) {
    // What lies between two of a leaf is of it too, where queries of a leaf come together.
    constexpr std::size_t kStride = 8;
    while (k + kStride <= end && is_of_leaf(k + kStride - 1)) k += kStride;
    while (k < end && is_of_leaf(k)) ++k;
    return k - query;
  }
  for (; k < end; ++k) {
    if (is_of_leaf(k)) continue;
    const Cell before = origin_;
    enter(k);
    if (!use_tiles_) continue;
    // Back to the leaf before, so that this one is entered when it is reached.
    origin_ = before;
    use_tiles_ = false;
    break;
  }
  return k - query;
}

void LeafTiles::enter(std::size_t query) noexcept {
  const Cell& c = queries_[query].voxel;
  origin_ = {c.x() & -kLeafEdge, c.y() & -kLeafEdge, c.z() & -kLeafEdge};
  made_ = {};
  const std::size_t last = query + kLeastQueriesForTile - 1;
  use_tiles_ = ns_ <= HeightTile::kMaxNs && last < queries_.size() && is_of_leaf(last);
}

void LeafTiles::make(const MapAxes& axes, HeightTile& tile) noexcept {
  tile.ns = ns_;
  tile.sign = axes.sign;
  tile.wants_even_rings = window_ == FitWindow::kEvenRings;
  map_kernels().tile(
      workpiece_.columns().around(axes.axis, origin_[axes.first()], origin_[axes.second()],
                                  origin_[axes.axis] - HeightTile::kBelow),
      tile);
}

}  // namespace sulcus
