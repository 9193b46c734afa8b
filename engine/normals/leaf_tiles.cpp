#include "engine/normals/leaf_tiles.hpp"

#include "engine/normals/map_kernels.hpp"

namespace sulcus {

const HeightTile* LeafTiles::find(std::size_t query, const MapAxes& axes) noexcept {
  if (ns_ > HeightTile::kMaxNs) return nullptr;
  const auto origin_of = [&](std::size_t k) {
    const Cell& c = queries_[k].voxel;
    return Cell(c.x() & -kLeafEdge, c.y() & -kLeafEdge, c.z() & -kLeafEdge);
  };
  if (const Cell origin = origin_of(query); origin != origin_) {
    origin_ = origin;
    made_ = {};
    const std::size_t last = query + kWorthwhile - 1;
    worthwhile_ = last < queries_.size() && origin_of(last) == origin;
  }
  if (!worthwhile_) return nullptr;
  const auto place = static_cast<std::size_t>(2 * axes.axis + (axes.sign > 0 ? 1 : 0));
  HeightTile& tile = tiles_[place];
  if (!made_[place]) {
    made_[place] = true;
    tile.ns = ns_;
    tile.sign = axes.sign;
    map_kernels().tile(
        workpiece_.columns().around(axes.axis, origin_[axes.first()], origin_[axes.second()],
                                    origin_[axes.axis] - HeightTile::kBelow),
        tile);
  }
  return &tile;
}

}  // namespace sulcus
