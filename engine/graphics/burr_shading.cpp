#include "engine/graphics/burr_shading.hpp"

#include <cstddef>

#include <Eigen/Geometry>

namespace sulcus {

std::vector<BurrCorner> shaded_corners(const TriangleMesh& mesh_tool) {
  constexpr float kCreaseCosine = 0.766f;
  const auto& p = mesh_tool.positions;
  // Lengths are scaled to the order of one: squares of areas in m^2 would underflow.
  constexpr float kPerMetre = 1e4f;
  std::vector<Eigen::Vector3f> area;
  area.reserve(mesh_tool.triangles.size());
  std::vector<std::vector<std::uint32_t>> around(p.size());
  for (std::size_t t = 0; t < mesh_tool.triangles.size(); ++t) {
    const auto& c = mesh_tool.triangles[t];
    const Eigen::Vector3f ab = kPerMetre * (p[c[1]] - p[c[0]]);
    const Eigen::Vector3f ac = kPerMetre * (p[c[2]] - p[c[0]]);
    area.push_back(ab.cross(ac));
    if (area.back().squaredNorm() == 0.0f) continue;
    for (const std::uint32_t corner : c) around[corner].push_back(static_cast<std::uint32_t>(t));
  }
  std::vector<BurrCorner> corners;
  corners.reserve(3 * mesh_tool.triangles.size());
  for (std::size_t t = 0; t < mesh_tool.triangles.size(); ++t) {
    if (area[t].squaredNorm() == 0.0f) continue;
    const Eigen::Vector3f own = area[t].normalized();
    for (const std::uint32_t corner : mesh_tool.triangles[t]) {
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (const std::uint32_t other : around[corner]) {
        if (area[other].normalized().dot(own) >= kCreaseCosine) sum += area[other];
      }
      const Eigen::Vector3f n = sum.normalized();
      corners.push_back({{p[corner].x(), p[corner].y(), p[corner].z()}, {n.x(), n.y(), n.z()}});
    }
  }
  return corners;
}

}  // namespace sulcus
