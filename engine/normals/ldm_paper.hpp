#pragma once

#include "engine/normals/surface_estimate.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Contact normal from the adaptive local distance map, Algorithm 1 of [Kim and Park 2019], with
/// what it leaves open closed as follows:
/// - rings: every new pixel of a ring is visited (section V-A), not only (k, k) and (-k, -k);
/// - a ring that holds a |z| beyond `trace` is dropped with all that lie outside it; at the first
///   ring the normal is the direction of projection (Algorithm 1, line 21);
/// - across an edge or corner the map's pixels are the lattice points of the plane through the
///   voxel and the columns run along the diagonal; |z| is a distance, steps times the diagonal's
///   length. There eqs. 3 and 4 with the stated `s` are wrong by 3.5 to 6.6 degrees, so the slope
///   is the weighted least-squares solution, of which they are the case of the square lattice;
/// - a pattern whose faces all oppose each other has no direction: undefined.
/// `neighbourhood` is NS, `trace` alpha, both in voxels. The offset is 0: the paper measures depth
/// at voxel centres. Pure, no allocation.
SurfaceEstimate estimate_ldm_paper(const Workpiece& workpiece, const Cell& voxel, int neighbourhood,
                                   int trace) noexcept;

}  // namespace sulcus
