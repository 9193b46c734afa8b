#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

namespace sulcus {

/// Indexed triangles, counter-clockwise seen from outside. The unit of the positions is said by
/// whoever hands the mesh over (metres unless named otherwise).
struct TriangleMesh {
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Moves every vertex, reckoned in doubles.
inline void transform(const Eigen::Affine3d& to_from_mesh, TriangleMesh& mesh) {
  for (Eigen::Vector3f& p : mesh.positions) {
    p = (to_from_mesh * p.cast<double>()).cast<float>();
  }
}

}  // namespace sulcus
