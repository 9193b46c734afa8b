#include "engine/normals/ldm_fast.hpp"

#include "engine/normals/coarse_normal.hpp"
#include "engine/normals/column_quadric.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

SurfaceEstimate estimate_ldm_fast(const Workpiece& workpiece, const Cell& voxel, int neighbourhood,
                                  int trace, const Eigen::Vector3f& outward) noexcept {
  Eigen::Vector3f coarse = coarse_normal(workpiece, voxel).cast<float>();
  if (coarse == Eigen::Vector3f::Zero()) coarse = outward;
  if (coarse == Eigen::Vector3f::Zero()) return {};
  int axis = 0;
  coarse.cwiseAbs().maxCoeff(&axis);

  const MapKernels& kernels = map_kernels();
  HeightMap map;
  map.ns = neighbourhood;
  map.sign = coarse[axis] > 0.0f ? 1 : -1;
  kernels.trace(workpiece.columns().around(axis, voxel[(axis + 1) % 3], voxel[(axis + 2) % 3],
                                           voxel[axis] - kLevel),
                trace, map);
  if (map.even_rings >= 1) {
    const QuadricFilter& filter = quadric_filter(map.even_rings, map.lanes);
    Quadric fitted;
    kernels.fit(map, filter, fitted);
    const SurfaceEstimate estimate =
        from_map_space(foot_of(column_quadric(fitted, filter, map.stride)), axis, map.sign);
    if (estimate.normal.dot(coarse) > 0.0f) return estimate;
  }
  // No map: an edge sharper than the steps allow. The face of the voxel is the best surface.
  return {coarse.normalized(), 0.5f, true};
}

}  // namespace sulcus
