#pragma once

#include "engine/normals/surface_estimate.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Largest neighbourhood a local distance map may have: what the border of ColumnBits allows.
inline constexpr int kMaxNeighbourhood = ColumnBits::kBorder;
/// Largest trace: heights must fit in a 64-bit window around the voxel.
inline constexpr int kMaxTrace = 24;

/// Normal and surface point from one local distance map, departing from [Kim and Park 2019, V] in:
/// - direction: the dominant axis of a coarse normal (unit vectors to the solid voxels within 2.5),
///   so that columns are axis-aligned everywhere;
/// - tracing: a column starts at its inner neighbour's height and may step by at most 2, so that
///   the map follows the surface down slopes and does not jump to the far side of a thin wall;
/// - window: a ring is rejected where a column fails, leaves |z| <= trace, or where opposite
///   pixels are out of line by more than 3 voxels, a test blind to tilt;
/// - weights: a taper, 1 - (r / (1.25 NS + 1))^2, instead of 1/r^2;
/// - offset: a weighted quadric gives the height of the surface above the voxel as well.
/// Undefined where the solid around the voxel is symmetric (a lone voxel, a wall of one voxel).
/// 1 <= neighbourhood <= kMaxNeighbourhood, 1 <= trace <= kMaxTrace. Pure, no allocation.
SurfaceEstimate estimate_ldm(const Workpiece& workpiece, const Cell& voxel, int neighbourhood,
                             int trace) noexcept;

}  // namespace sulcus
