#include "engine/normals/map_group.hpp"

#include <algorithm>

#include "engine/normals/coarse_normal.hpp"

namespace sulcus {

std::size_t MapGroup::trace(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                            std::size_t first, int neighbourhood, int trace,
                            LeafTiles& tiles) noexcept {
  count_ = std::min(queries.size() - first, kSize);
  const MapKernels& kernels = map_kernels();
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
    if (const HeightTile* tile = tiles.find(first + k, axes[k])) {
      const Eigen::Vector3i at = in_tile(query.voxel, axes[k]);
      if (kernels.cut(*tile, at.x(), at.y(), at.z(), trace, map)) {
        const int height = tile->at(at.x(), at.y());
        QuadricSums sums;
        for (std::size_t f = 0; f < kQuadric; ++f) sums[f] = tile->sums[at.y()][f][at.x()];
        surfaces.put(static_cast<int>(k), sums, height, height - at.z(), map.sign, whole);
        summed_[k] = true;
        continue;
      }
    }
    trace_along(workpiece, query.voxel, axes[k], trace, map);
  }
  return count_;
}

}  // namespace sulcus
