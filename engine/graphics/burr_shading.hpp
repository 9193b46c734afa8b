#pragma once

#include <array>
#include <vector>

#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// A triangle's corner as the graphics card gets it.
struct BurrCorner {
  std::array<float, 3> position_tool;  // m
  std::array<float, 3> normal_tool;
};

/// Three corners per triangle, with normals that are smooth but for creases: the mean of the
/// triangles round the corner's vertex within 40 degrees of its own, by area. Triangles without an
/// area are left out.
std::vector<BurrCorner> shaded_corners(const TriangleMesh& mesh_tool);

}  // namespace sulcus
