#include "engine/normals/map_group.hpp"

#include <algorithm>

#include "engine/normals/coarse_normal.hpp"

namespace sulcus {

Eigen::Vector3f coarse_of(const Workpiece& workpiece, const VoxelQuery& query) noexcept {
  const Eigen::Vector3f coarse = coarse_normal(workpiece, query.voxel).cast<float>();
  return coarse == Eigen::Vector3f::Zero() ? query.outward : coarse;
}

bool trace_or_cut(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes, int trace,
                  const HeightTile* tile, HeightMap& map) noexcept {
  map.sign = axes.sign;
  if (tile) {
    const Eigen::Vector3i at = in_tile(voxel, axes);
    if (map_kernels().cut(*tile, at.x(), at.y(), at.z(), trace, map)) return true;
  }
  trace_along(workpiece, voxel, axes, trace, map);
  return false;
}

std::size_t MapGroup::trace(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                            std::size_t first, int neighbourhood, int trace,
                            LeafTiles& tiles) noexcept {
  count_ = std::min(queries.size() - first, kSize);
  for (std::size_t k = 0; k < count_; ++k) {
    const VoxelQuery& query = queries[first + k];
    coarse[k] = coarse_of(workpiece, query);
    axes[k] = dominant_axes(coarse[k]);

    HeightMap& map = maps[k];
    map.ns = neighbourhood;
    map.stride = 1;
    map.sign = axes[k].sign;
    map.whole_rings = map.even_rings = -1;
    summed_[k] = false;
    if (coarse[k] == Eigen::Vector3f::Zero()) continue;
    const HeightTile* tile = tiles.find(first + k, axes[k]);
    summed_[k] = trace_or_cut(workpiece, query.voxel, axes[k], trace, tile, map);
    if (summed_[k]) {
      put_tile_sums(*tile, in_tile(query.voxel, axes[k]), quadric_filter(neighbourhood, map.lanes),
                    surfaces, static_cast<int>(k));
    }
  }
  return count_;
}

}  // namespace sulcus
