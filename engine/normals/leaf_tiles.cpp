#include "engine/normals/leaf_tiles.hpp"

#include "engine/normals/map_kernels.hpp"

namespace sulcus {

void LeafTiles::enter(std::size_t query) noexcept {
  const auto leaf_of = [&](std::size_t k) {
    const Cell& c = queries_[k].voxel;
    return Cell(c.x() & -kLeafEdge, c.y() & -kLeafEdge, c.z() & -kLeafEdge);
  };
  origin_ = leaf_of(query);
  made_ = {};
  const std::size_t last = query + kWorthwhile - 1;
  worthwhile_ = ns_ <= HeightTile::kMaxNs && last < queries_.size() && leaf_of(last) == origin_;
}

void LeafTiles::make(const MapAxes& axes, HeightTile& tile) noexcept {
  tile.ns = ns_;
  tile.sign = axes.sign;
  tile.wants_even_rings = wants_even_rings_;
  map_kernels().tile(
      workpiece_.columns().around(axes.axis, origin_[axes.first()], origin_[axes.second()],
                                  origin_[axes.axis] - HeightTile::kBelow),
      tile);
}

}  // namespace sulcus
