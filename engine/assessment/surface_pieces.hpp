#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// Of a triangle, in its mesh's space and unit.
using TriangleCorners = std::array<Eigen::Vector3d, 3>;

inline TriangleCorners corners_of(const TriangleMesh& mesh,
                                  const std::array<std::uint32_t, 3>& triangle) {
  return {mesh.positions[triangle[0]].cast<double>(), mesh.positions[triangle[1]].cast<double>(),
          mesh.positions[triangle[2]].cast<double>()};
}

/// A piece of a triangle, small enough to be somewhere.
struct SurfacePiece {
  TriangleCorners corner;

  Eigen::Vector3d middle() const { return (corner[0] + corner[1] + corner[2]) / 3.0; }
  /// Outward, of length 1; 0 of one without area.
  Eigen::Vector3d normal() const { return twice().normalized(); }
  double area() const { return 0.5 * twice().norm(); }

 private:
  Eigen::Vector3d twice() const { return (corner[1] - corner[0]).cross(corner[2] - corner[0]); }
};

/// Calls `visit(piece)` for the pieces of a triangle, halved until no edge is longer than `most`.
template <class Visit>
void for_each_piece(const TriangleCorners& corner, double most, const Visit& visit) {
  std::size_t from = 0;  // of the longest edge
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double length = (corner[(i + 1) % 3] - corner[i]).norm();
    if (length > longest) longest = length, from = i;
  }
  if (longest <= most) return visit(SurfacePiece{corner});
  const std::size_t to = (from + 1) % 3;
  const Eigen::Vector3d middle = 0.5 * (corner[from] + corner[to]);
  // No triangle, however large, in more than about a million.
  const double at_least = std::max(most, 1e-3 * longest);
  TriangleCorners half = corner;
  half[to] = middle;
  for_each_piece(half, at_least, visit);
  half = corner;
  half[from] = middle;
  for_each_piece(half, at_least, visit);
}

}  // namespace sulcus
