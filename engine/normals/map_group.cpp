#include "engine/normals/map_group.hpp"

#include <algorithm>

#include "engine/normals/coarse_normal.hpp"

namespace sulcus {

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
  const QuadricFilter& whole = quadric_filter(neighbourhood, lanes_of(neighbourhood));
  for (std::size_t k = 0; k < count_; ++k) {
    const VoxelQuery& query = queries[first + k];
    coarse[k] = coarse_normal(workpiece, query.voxel).cast<float>();
    if (coarse[k] == Eigen::Vector3f::Zero()) coarse[k] = query.outward;
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
    if (!summed_[k]) continue;
    const Eigen::Vector3i at = in_tile(query.voxel, axes[k]);
    const int height = tile->at(at.x(), at.y());
    QuadricSums sums;
    for (std::size_t f = 0; f < kQuadric; ++f) sums[f] = tile->sums[at.y()][f][at.x()];
    surfaces.put(static_cast<int>(k), sums, height, height - at.z(), map.sign, whole);
  }
  return count_;
}

}  // namespace sulcus
