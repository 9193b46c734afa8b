#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace sulcus {

/// What a normal method says of the surface at a voxel, in index space (voxels; the axes are the
/// world's). Undefined: the pattern of the voxel allows no direction, and the caller takes the
/// tool's distance gradient; never NaN.
struct SurfaceEstimate {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit, out of the solid
  float offset = 0.0f;  // of the surface from the voxel's centre along the normal, voxels
  bool defined = false;
  /// Where ldm and ldm_fast looked: bit a, a map along axis a; bit 3, one of every other column
  /// too. What lies in none of these windows has no part in the estimate.
  std::uint8_t windows = 0;

  bool looked_along(std::size_t axis) const { return (windows >> axis & 1) != 0; }
  bool looked_wide() const { return (windows & kWideWindow) != 0; }
  static constexpr std::uint8_t kWideWindow = 8;
};

}  // namespace sulcus
