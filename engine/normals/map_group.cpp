#include "engine/normals/map_group.hpp"

#include "engine/normals/coarse_normal.hpp"

namespace sulcus {

void MapGroup::trace(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                     int neighbourhood, int trace) noexcept {
  count_ = queries.size();
  for (std::size_t k = 0; k < count_; ++k) {
    coarse[k] = coarse_normal(workpiece, queries[k].voxel).cast<float>();
    if (coarse[k] == Eigen::Vector3f::Zero()) coarse[k] = queries[k].outward;
    axes[k] = dominant_axes(coarse[k]);
  }
  for (HeightMap& map : maps) {
    map.ns = neighbourhood;
    map.stride = 1;
    map.whole_rings = map.even_rings = -1;
  }
  for (std::size_t k = 0; k < count_; ++k) {
    if (coarse[k] == Eigen::Vector3f::Zero()) continue;
    trace_along(workpiece, queries[k].voxel, axes[k], trace, maps[k]);
  }
}

}  // namespace sulcus
