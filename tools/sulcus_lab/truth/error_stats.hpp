#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "engine/normals/surface_estimate.hpp"
#include "tools/sulcus_lab/truth/truth_shapes.hpp"

namespace sulcus::lab {

/// An estimate as the tool lets it stand: where the tool's side is known (`tool_direction`,
/// outward, unit), what is undefined or points away from it gives way to it.
SurfaceEstimate with_tool_direction(const SurfaceEstimate& estimate,
                                    const std::optional<Eigen::Vector3d>& tool_direction);

/// An estimate of a method that finds no sign, turned to the side of the truth: in its favour
/// against those that find the sign themselves.
SurfaceEstimate turned_outward(SurfaceEstimate estimate, const TruthVoxel& truth);

/// Angle between an estimate and the truth at a voxel of `shape`, degrees, after
/// `with_tool_direction`; to the nearer of the two signs where the wall has no side of its own.
/// None where the estimate is still undefined.
std::optional<float> error_deg(const SurfaceEstimate& estimate, const TruthVoxel& truth,
                               const TruthShape& shape);

/// Of angles in degrees; all 0 where there are none. `p95`: the smallest that 95 % do not exceed.
struct ErrorStats {
  double mean = 0.0, p95 = 0.0, max = 0.0;
};
ErrorStats error_stats(std::vector<float> errors_deg);

}  // namespace sulcus::lab
