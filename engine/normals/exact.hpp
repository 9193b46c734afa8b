#pragma once

#include "engine/normals/surface_estimate.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// The offline reference of [Kim and Park 2019, VI]: exact Euclidean distances in the cube of
/// 2 NS + 1 voxels about the voxel, their gradients by the 3 x 3 x 3 Prewitt operator, and the
/// gradients averaged by the adaptive filter of [Flin et al. 2005] under its criteria of angle and
/// symmetry. What the two leave open:
/// - distances are signed, between the centres of a voxel and of the nearest of the other kind in
///   the cube, less half a voxel: the surface lies half-way between two neighbours of which one is
///   solid, and what lies outside says as much about it as what lies inside;
/// - the filter reaches over the ball in the cube of known gradients, which lacks the outermost
///   layer: squared offsets up to NS (NS - 1), a radius of NS - 1/2. At NS = 6 that is 5.5; [Kim
///   and Park 2019, V-A] cite Flin et al. for 5 being enough;
/// - angle: a gradient counts if it is within 30 degrees of that at the voxel. The latter is off by
///   up to 24 degrees on a sphere, so that a closer limit loses what should count;
/// - symmetry: it counts only if its mirror image through the voxel counts too, so that what is
///   averaged stays centred.
/// The offset is minus the mean of the signed distances that were averaged, of those within 3
/// voxels: at the voxel itself every surface voxel has half a voxel, and further out curvature
/// shows. Undefined: the gradient at the voxel vanishes (a lone voxel, a wall of one voxel, nothing
/// but solid or nothing but void in the cube). 1 <= neighbourhood <= 12. Pure, no allocation; about
/// 160 kB of stack.
SurfaceEstimate estimate_exact(const Workpiece& workpiece, const Cell& voxel,
                               int neighbourhood) noexcept;

}  // namespace sulcus
