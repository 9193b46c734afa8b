#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// Indexed triangles, counter-clockwise seen from outside. The unit of the positions is said by
/// whoever hands the mesh over (metres unless named otherwise).
struct TriangleMesh {
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace sulcus
