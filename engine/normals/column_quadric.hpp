#pragma once

#include <array>

#include <Eigen/Core>

#include "engine/normals/surface_estimate.hpp"

namespace sulcus {

struct QuadricFilter;

/// Coefficients of a quadric, z = c0 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2.
inline constexpr int kQuadric = 6;
using Quadric = std::array<float, kQuadric>;

/// Height over the plane of a map's columns of a surface that is a quadric in its own tangent
/// frame.
///
/// With slopes s and Hessian H of the height at the origin, g^2 = 1 / (1 + |s|^2), and
/// z2 = 1/2 x'Hx, the surface n'X = 1/2 X'KX solves order by order to
///   z3 = z2 t,  t = g^2 s'Hx,   z4 = z2 t^2 + 1/2 g^2 (g^2 s'Hs) z2^2,
/// so that aslant a quadric has a cubic and a quartic part in the columns' frame, given by its
/// slopes and curvatures. Ignoring them tilts the fit: by a degree at 45 degrees on a cap of 30
/// voxels' radius.
struct ColumnQuadric {
  Quadric c{};             // to second order; map space: voxels, z outward
  float t_x = 0, t_y = 0;  // t = t_x x + t_y y
  float quartic = 0;       // 1/2 g^2 (g^2 s'Hs)
};

/// The quadric whose heights give these coefficients under a filter, by two corrections of what the
/// filter makes of the cubic and quartic part; `stride` voxels between columns. `fitted` is in
/// columns.
ColumnQuadric column_quadric(const Quadric& fitted, const QuadricFilter& filter,
                             int stride) noexcept;

/// Unit normal of a surface at the foot of the origin on it, and how far out along it that is.
struct Foot {
  Eigen::Vector3f normal;
  float offset;
};

/// The foot of the origin, by two steps along the normal from the point above it: on the flat
/// surfaces of a map the rest is far below the noise of its heights.
Foot foot_of(const ColumnQuadric& surface) noexcept;

/// What is known in map space (i, j, outward), told in index space.
inline SurfaceEstimate from_map_space(const Foot& foot, int axis, int sign) noexcept {
  SurfaceEstimate estimate;
  estimate.normal[(axis + 1) % 3] = foot.normal.x();
  estimate.normal[(axis + 2) % 3] = foot.normal.y();
  estimate.normal[axis] = static_cast<float>(sign) * foot.normal.z();
  estimate.offset = foot.offset;
  estimate.defined = true;
  return estimate;
}

}  // namespace sulcus
