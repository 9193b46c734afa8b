#include "engine/normals/ldm_fast.hpp"

#include "engine/normals/map_group.hpp"

namespace sulcus {

void estimate_ldm_fast(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                       int neighbourhood, int trace,
                       std::span<SurfaceEstimate> estimates) noexcept {
  MapGroup group;
  LeafTiles tiles(workpiece, queries, neighbourhood);
  for (std::size_t first = 0; first < queries.size(); first += MapGroup::kSize) {
    const std::size_t count = group.trace(workpiece, queries, first, neighbourhood, trace, tiles);
    group.fit([](const HeightMap& map) { return map.even_rings; });
    for (std::size_t k = 0; k < count; ++k) {
      SurfaceEstimate& estimate = estimates[first + k];
      const Eigen::Vector3f& coarse = group.coarse[k];
      estimate = {};
      if (coarse == Eigen::Vector3f::Zero()) continue;
      if (group.maps[k].even_rings >= 1) {
        estimate = to_index_space(group.surfaces.foot(static_cast<int>(k)), group.axes[k]);
        if (stands(estimate.normal, coarse, heard(queries[first + k].outward, coarse))) continue;
      }
      // No map: an edge sharper than the steps allow. The face of the voxel is the best surface.
      estimate = {coarse.normalized(), 0.5f, true};
    }
  }
}

}  // namespace sulcus
