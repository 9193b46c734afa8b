#include "tools/sulcus_lab/truth/error_stats.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"

namespace sulcus::lab {

SurfaceEstimate with_tool_direction(const SurfaceEstimate& estimate,
                                    const std::optional<Eigen::Vector3d>& tool_direction) {
  if (!tool_direction) return estimate;
  const Eigen::Vector3f tool = tool_direction->cast<float>();
  if (estimate.defined && estimate.normal.dot(tool) >= 0.0f) return estimate;
  return {tool, 0.0f, true};
}

SurfaceEstimate turned_outward(SurfaceEstimate estimate, const TruthVoxel& truth) {
  if (estimate.normal.cast<double>().dot(truth.normal) < 0.0) estimate.normal = -estimate.normal;
  return estimate;
}

std::optional<float> error_deg(const SurfaceEstimate& estimate, const TruthVoxel& truth,
                               const TruthShape& shape) {
  const SurfaceEstimate used = with_tool_direction(estimate, shape.tool_direction);
  if (!used.defined) return std::nullopt;
  const Eigen::Vector3d normal = used.normal.cast<double>();
  double cosine = normal.dot(truth.normal);
  if (shape.either_sign) cosine = std::abs(cosine);
  // Of small angles the cosine says nothing.
  return static_cast<float>(std::atan2(normal.cross(truth.normal).norm(), cosine) / kDegree);
}

ErrorStats error_stats(std::vector<float> errors_deg) {
  if (errors_deg.empty()) return {};
  std::sort(errors_deg.begin(), errors_deg.end());
  const auto count = static_cast<double>(errors_deg.size());
  const auto p95 = static_cast<std::size_t>(std::ceil(0.95 * count)) - 1;
  return {std::accumulate(errors_deg.begin(), errors_deg.end(), 0.0) / count,
          static_cast<double>(errors_deg[p95]), static_cast<double>(errors_deg.back())};
}

}  // namespace sulcus::lab
