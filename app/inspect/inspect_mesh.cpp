#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "app/inspect/inspect.hpp"
#include "engine/core/units.hpp"
#include "engine/import/mesh_file.hpp"

namespace sulcus {

void inspect_mesh(const std::string& file) {
  const TriangleMesh mesh = read_mesh(file);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p);
  double volume_m3 = 0.0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[t[2]].cast<double>();
    volume_m3 += a.dot(b.cross(c)) / 6.0;
    for (int e = 0; e < 3; ++e) edges.emplace_back(t[e], t[(e + 1) % 3]);
  }
  std::sort(edges.begin(), edges.end());
  const auto open = std::count_if(edges.begin(), edges.end(), [&](const auto& e) {
    return !std::binary_search(edges.begin(), edges.end(), std::pair(e.second, e.first));
  });
  const Eigen::Vector3d size_mm = box.sizes().cast<double>() / kMillimetre;
  std::printf("mesh             %zu triangles, %zu vertices\n", mesh.triangles.size(),
              mesh.positions.size());
  std::printf("size             %.3f x %.3f x %.3f mm\n", size_mm.x(), size_mm.y(), size_mm.z());
  std::printf("volume           %.3f mm3\n", volume_m3 * 1e9);
  std::printf("open edges       %td%s\n", open, open == 0 ? " (closed)" : "");
}

}  // namespace sulcus
