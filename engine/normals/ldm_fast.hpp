#pragma once

#include <span>

#include "engine/normals/height_map.hpp"
#include "engine/normals/surface_estimate.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Normal and surface point from one local distance map and one fit, for what a tick must have at
/// once, departing from [Kim and Park 2019, V] in:
/// - direction: the dominant axis of a coarse normal, so that columns are axis-aligned everywhere;
/// - tracing: a column starts at its inner neighbour's height and may step by at most 2, so that
///   the map follows the surface down slopes and does not jump to the far side of a thin wall;
/// - window: a ring is rejected where a column fails, leaves |z| <= trace, or where opposite
///   pixels are out of line by more than 3 voxels (2 in a window of five rings or more,
///   most_uneven), a test blind to tilt;
/// - window weights: 1 - r^2 / (2.5 NS^2) instead of 1/r^2;
/// - fit: a weighted quadric, corrected for what it becomes tilted, instead of a plane; the normal
///   and the offset are those at the closest point to the voxel's centre;
/// - faces, from NS 4 to 7: where the quadric of a whole map is nearly flat, one of every other
///   column sees twice as far, and is taken if it is flat too;
/// - edges: where no more than two rings are even, the face that the voxel's nearest columns and
///   half of the map's lie on (grow_plane), where there is one.
/// - symmetry: as with estimate_ldm.
/// No normal points away from the coarse one; what does, or what `VoxelQuery::outward` vetoes as in
/// estimate_ldm, gives way to it. Undefined only where `outward` and the coarse normal are
/// zero. 1 <= neighbourhood <= kMaxNeighbourhood, 1 <= trace <= kMaxTrace. Pure, no allocation. One
/// estimate for each query, up to 64 of a leaf at a time.
void estimate_ldm_fast(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                       int neighbourhood, int trace, std::span<SurfaceEstimate> estimates) noexcept;

}  // namespace sulcus
