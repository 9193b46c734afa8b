#pragma once

#include <span>

#include "engine/normals/surface_estimate.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// The local distance map of a solid with fractions: `ldm` and `ldm_fast` there. Heights are exact
/// to a hundredth of a voxel, so that a surface may be asked to explain all of them:
/// - the quadric over the whole map;
/// - else the largest ball about the voxel that a quadric explains, in the frame of the coarse
///   normal;
/// - else, near an edge, of what explains the sides of balls, along all axes that the coarse normal
///   leaves, the nearest to the voxel: its own face;
/// - else, and where no column has a part-filled voxel, what `ldm` makes of the bits.
/// What scatters more, as greys do, is explained within its own noise (height_noise).
///
/// The surface is then moved to the heights of the voxel's own columns (farthest_surface).
///
/// A function of the bits and levels within the windows alone, and of the tool's veto; equal under
/// the 48 symmetries of the grid. Estimates as estimate_ldm's; pure, no allocation. Needs fractions
/// (Workpiece::has_fills).
void estimate_ldm_filled(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                         int neighbourhood, int trace,
                         std::span<SurfaceEstimate> estimates) noexcept;

}  // namespace sulcus
