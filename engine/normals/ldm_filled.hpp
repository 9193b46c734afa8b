#pragma once

#include <span>

#include "engine/normals/surface_estimate.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// The local distance map of a solid with fractions: `ldm` and `ldm_fast` there. Heights are exact
/// to a hundredth of a voxel, so that a quadric may be asked to explain all of a window's:
/// - the whole map's;
/// - else those of the largest of the smaller windows about the voxel;
/// - else, near an edge, of the windows about the voxel and up to three columns aside, along all
///   axes that the coarse normal leaves, the nearest to the voxel that scatters little: its own
///   face [as schemes that do not oscillate choose their stencils: Harten et al. 1987];
/// - else, and where no column has a part-filled voxel, what `ldm` makes of the bits.
/// What scatters alike everywhere, as greys do, is explained within that.
///
/// The surface is then moved to the heights of the voxel's own columns (farthest_surface).
///
/// The map has 2 to 7 rings (`neighbourhood`, else the nearest of those) and heights up to 10
/// voxels from the voxel (`trace`, where that is less). A function of the bits and levels within
/// the windows alone, and of the tool's veto; equal under the 48 symmetries of the grid. Estimates
/// as estimate_ldm's; pure, no allocation. Needs fractions (Workpiece::has_fills).
void estimate_ldm_filled(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                         int neighbourhood, int trace,
                         std::span<SurfaceEstimate> estimates) noexcept;

}  // namespace sulcus
