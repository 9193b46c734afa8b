#include "engine/normals/equal_axes.hpp"

#include <algorithm>
#include <cmath>

#include "engine/normals/ldm_tuning.hpp"

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
  if (!mean.defined) return mean;
  mean.normal /= length;
  mean.offset /= static_cast<float>(estimates.size());
  return mean;
}

SurfaceEstimate most_level(std::span<const AxisEstimate> estimates) noexcept {
  const auto level = [](const AxisEstimate& of) { return std::abs(of.estimate.normal[of.axis]); };
  float most = 0.0f;
  for (const AxisEstimate& of : estimates) most = std::max(most, level(of));
  std::array<SurfaceEstimate, 3> chosen;
  std::size_t count = 0;
  std::uint8_t windows = 0;
  for (const AxisEstimate& of : estimates) {
    windows |= of.estimate.windows;
    if (level(of) >= most - kAsLevel) chosen[count++] = of.estimate;
  }
  SurfaceEstimate mean = mean_of(std::span(chosen).first(count));
  mean.windows = windows;
  return mean;
}

}  // namespace sulcus
