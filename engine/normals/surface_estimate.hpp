#pragma once

#include <Eigen/Core>

namespace sulcus {

/// What a normal method says of the surface at a voxel, in index space (voxels; the axes are the
/// world's). Undefined: the pattern of the voxel allows no direction, and the caller takes the
/// tool's distance gradient; never NaN.
struct SurfaceEstimate {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit, out of the solid
  float offset = 0.0f;  // of the surface from the voxel's centre along the normal, voxels
  bool defined = false;
};

}  // namespace sulcus
