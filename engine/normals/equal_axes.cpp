#include "engine/normals/equal_axes.hpp"

namespace sulcus {

SurfaceEstimate mean_of(std::span<const SurfaceEstimate> estimates) noexcept {
  constexpr float kLeastLength = 1e-3f;  // of the sum of unit normals
  SurfaceEstimate mean;
  mean.defined = true;
  for (const SurfaceEstimate& estimate : estimates) {
    mean.normal += estimate.normal;
    mean.offset += estimate.offset;
    mean.windows |= estimate.windows;
    mean.defined = mean.defined && estimate.defined;
  }
  const float length = mean.normal.norm();
  mean.defined = mean.defined && length > kLeastLength;
  mean.normal /= length;
  mean.offset /= static_cast<float>(estimates.size());
  return mean;
}

}  // namespace sulcus
