#include "engine/normals/ldm_fast.hpp"

#include <algorithm>
#include <array>

#include "engine/normals/leaf_tiles.hpp"
#include "engine/normals/map_group.hpp"

namespace sulcus {

namespace {

/// So many voxels go through each step before the next, which then do not wait for one another.
constexpr std::size_t kBatch = 64;
constexpr std::size_t kGroups = kBatch / SurfaceGroup::kSize;

struct Batch {
  std::array<Eigen::Vector3f, kBatch> coarse;
  std::array<MapAxes, kBatch> axes;
  std::array<bool, kBatch> fitted;
  std::array<SurfaceGroup, kGroups> surfaces;
};

/// Sums of the largest even window, from the leaf's tile where that tells; false where there is
/// none.
bool fit(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes, int neighbourhood,
         int trace, const HeightTile* tile, SurfaceGroup& group, int place) noexcept {
  const MapKernels& kernels = map_kernels();
  if (tile) {
    const Eigen::Vector3i at = in_tile(voxel, axes);
    if (kernels.even(*tile, at.x(), at.y(), at.z(), trace)) {
      put_tile_sums(*tile, at, group, place);
      return true;
    }
  }
  HeightMap map;
  map.ns = neighbourhood;
  trace_or_cut(workpiece, voxel, axes, trace, tile, map);
  if (map.even_rings < 1) return false;
  const QuadricFilter& filter = quadric_filter(map.even_rings, map.lanes);
  QuadricSums sums;
  kernels.fit(map, filter, sums);
  group.put(place, sums, map.at(0, 0), map.at(0, 0), axes.sign, filter);
  return true;
}

}  // namespace

void estimate_ldm_fast(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                       int neighbourhood, int trace,
                       std::span<SurfaceEstimate> estimates) noexcept {
  LeafTiles tiles(workpiece, queries, neighbourhood);
  Batch batch;
  for (std::size_t first = 0; first < queries.size(); first += kBatch) {
    const std::size_t count = std::min(queries.size() - first, kBatch);
    for (std::size_t k = 0; k < count; ++k) {
      batch.coarse[k] = coarse_of(workpiece, queries[first + k]);
      batch.axes[k] = dominant_axes(batch.coarse[k]);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const MapAxes& axes = batch.axes[k];
      batch.fitted[k] = batch.coarse[k] != Eigen::Vector3f::Zero() &&
                        fit(workpiece, queries[first + k].voxel, axes, neighbourhood, trace,
                            tiles.find(first + k, axes), batch.surfaces[k / SurfaceGroup::kSize],
                            static_cast<int>(k % SurfaceGroup::kSize));
    }
    map_kernels().feet(batch.surfaces.data(),
                       (count + SurfaceGroup::kSize - 1) / SurfaceGroup::kSize);
    for (std::size_t k = 0; k < count; ++k) {
      SurfaceEstimate& estimate = estimates[first + k];
      const Eigen::Vector3f& coarse = batch.coarse[k];
      if (coarse == Eigen::Vector3f::Zero()) {
        estimate = {};
        continue;
      }
      if (batch.fitted[k]) {
        const SurfaceGroup& group = batch.surfaces[k / SurfaceGroup::kSize];
        estimate =
            to_index_space(group.foot(static_cast<int>(k % SurfaceGroup::kSize)), batch.axes[k]);
        if (stands(estimate.normal, coarse, heard(queries[first + k].outward, coarse))) continue;
      }
      // No map: an edge sharper than the steps allow. The face of the voxel is the best surface.
      estimate = {coarse.normalized(), 0.5f, true, batch.axes[k].window()};
    }
  }
}

}  // namespace sulcus
