#pragma once

#include "engine/normals/surface_estimate.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// What a weighted sum adds up of each solid voxel at x, distance d from the one in question.
enum class WeightedSum {
  kAsStated,   // the offset with the weight 1/d: x / d
  kAsPlotted,  // the direction with the weight 1/d^2: x / d^3
};

/// The weighted sum (WS) that [Kim and Park 2019, VI-C] compares with, after [Thuermer and
/// Wuethrich 1997]: the normal is minus the sum over the solid voxels in the cube of 2 NS + 1 about
/// the voxel. The paper states the weight 1/d, yet its fig. 8 settles at 2 degrees. Mean errors
/// measured on its sphere (radius 102.4, NS = 6) say that those are two methods: x / d 3.55, x /
/// d^2 2.49, x / d^3 1.91. The last is 1/d^2 on directions, the weight that [II-B] calls the most
/// effective. The offset is 0: depth is measured at voxel centres. Undefined: the sum is zero (a
/// lone voxel, a wall of one voxel). 1 <= neighbourhood <= 12. Pure, no allocation.
SurfaceEstimate estimate_weighted_sum(const Workpiece& workpiece, const Cell& voxel,
                                      int neighbourhood, WeightedSum kind) noexcept;

}  // namespace sulcus
