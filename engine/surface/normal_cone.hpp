#pragma once

#include <Eigen/Geometry>

#include "engine/surface/drawn_surface.hpp"

namespace sulcus {

/// A cone that holds the normals of all triangles of a mesh. Where none shows its front, nothing of
/// the mesh does: half of a tooth need not be drawn.
struct NormalCone {
  Eigen::Vector3f axis = Eigen::Vector3f::UnitZ();  // unit
  float cosine = -1.0f;  // of the half angle, at most; 0 or less: nothing is known
};
NormalCone normal_cone(const DrawnMesh& mesh);

/// Whether no triangle within `box` faces the eye, m in the space of the mesh. May be false all the
/// same.
bool faces_away(const NormalCone& cone, const Eigen::AlignedBox3f& box, const Eigen::Vector3f& eye);

}  // namespace sulcus
