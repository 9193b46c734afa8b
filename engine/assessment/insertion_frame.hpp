#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Geometry>

#include "engine/assessment/ray_mask.hpp"
#include "engine/assessment/ray_stack.hpp"
#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// Between rays where a rough look is enough.
inline constexpr double kCoarsePitch_mm = 0.1;
/// What two surfaces of one tooth may differ by and be the same.
inline constexpr double kSame_mm = 0.05;

/// The frame that a preparation is measured in: mm, z along the path of insertion, a unit vector.
Eigen::Affine3d insertion_frame_from_m(const Eigen::Vector3d& insertion);

TriangleMesh moved(const TriangleMesh& mesh, const Eigen::Affine3d& to);

/// Of a mesh in that frame, across the path.
Eigen::AlignedBox2d box_of(const TriangleMesh& mesh);

/// Rays that stand `pitch_mm` apart, or so far that there are at most 2 million.
RayLattice lattice_over(const Eigen::AlignedBox2d& box, double pitch_mm);

/// The rays on which something was removed, as far as `reach_mm` from where it is thicker, to all
/// sides, than what two surfaces of one tooth leave between each other, which is long along a ray
/// on steep faces. All of them where `reach_mm` is infinite.
RayMask cut_rays(const RayStack& before, const RayStack& after, const RayLattice& lattice,
                 double reach_mm);

/// Where something was removed, roughly, slivers among it; empty where nothing was.
Eigen::AlignedBox2d box_of_removed(const TriangleMesh& before, const TriangleMesh& after);

Eigen::AlignedBox2d widened(const Eigen::AlignedBox2d& box, double by_mm);

/// Whether a solid reaches further than kSame_mm beyond a point to all sides.
bool is_deep_in(const RayStack& solid, const RayLattice& lattice, const Eigen::Vector3d& p_mm);
/// Whether it stays further away than that, likewise.
bool is_clear_of(const RayStack& solid, const RayLattice& lattice, const Eigen::Vector3d& p_mm);
/// Whether what was removed along a ray is thicker than that, likewise.
bool is_thick(const RayStack& before, const RayStack& after, const RayLattice& lattice,
              std::size_t place, const RayStack::Span& removed);

/// Whether two meshes are of one tooth in one place: the share of the second's volume that lies
/// outside of the first, by rays kCoarsePitch_mm apart. What was cut lies in what was there. None
/// where the second encloses so little that it lies between them.
std::optional<double> share_outside(const TriangleMesh& before, const TriangleMesh& after,
                                    const Eigen::Vector3d& insertion);

}  // namespace sulcus
