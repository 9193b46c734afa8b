#pragma once

#include <span>

#include "engine/normals/height_map.hpp"
#include "engine/normals/surface_estimate.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Normal and surface point from local distance maps, accurate on smooth surfaces, edges and thin
/// walls with one setting. Further from [Kim and Park 2019, V] than `ldm_fast`:
/// - where the map along the dominant axis is whole, and one quadric explains all its heights to
///   their quantisation, that is the surface; near level, and on faces, a map of every other column
///   stands in for it (extended_plane where that is not whole);
/// - least squares is where a fit begins: since quantisation leaves residuals spread evenly up to
///   a bound, not in a bell, a step towards the least sum of fourth powers follows;
/// - where a plane explains what a quadric does, it grows over all columns of the map that lie on
///   it, up to the edges of the face (grow_plane);
/// - where columns all over the map are out of line with their neighbours, and the quadric of the
///   largest ball bends and scatters little, the surface is rough, and that is its mean;
/// - else the largest ball about the voxel in which a quadric does, fitted in the frame of
///   the coarse normal, where a curved surface is a quadric farther out than in the columns' frame.
///   The quantisation of the heights enters the abscissas of that frame as well; what it adds to
///   the normal equations is taken off. Where its slopes are near to whole numbers, the face that
///   a map of every other column lies on stands in for it;
/// - where only a small ball is explained, the voxel is near an edge: of the planes through eight
///   half-discs of the map, and of a map along the second axis, the one whose face passes nearest
///   to the voxel; where none is plane, and first of all where that ball is inside a face, what
///   explains the part of a ball on one side;
/// - normal and offset are those of the closest point to the voxel's centre.
/// - equal shapes have equal normals, however they lie in the grid: exchanging axes, or their
///   directions, changes rounding alone (TraceOrder, TurnedMap; estimate_equal_axes where two axes
///   or three dominate the coarse normal).
/// No normal points away from the coarse one. `VoxelQuery::outward` stands in for the coarse normal
/// where the solid around the voxel is symmetric (a lone voxel, a wall of one voxel), and vetoes:
/// where the normal points away from it though the coarse one does not do so by 120 degrees, as
/// with the wrong face of an edge, the nearest face that does not is taken, else the coarse normal,
/// else `outward` itself. (Beyond 120 degrees it is the far side of a wall.) Undefined only where
/// both are zero. 1 <= neighbourhood <= kMaxNeighbourhood, 1 <= trace <= kMaxTrace. Pure, no
/// allocation. One estimate for each query, up to 16 of a leaf at a time.
void estimate_ldm(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                  int neighbourhood, int trace, std::span<SurfaceEstimate> estimates) noexcept;

}  // namespace sulcus
