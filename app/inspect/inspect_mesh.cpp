#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "app/inspect/inspect.hpp"
#include "app/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/mesh_file.hpp"
#include "engine/import/voxelise_mesh.hpp"

namespace sulcus {

namespace {

/// Parts that share no vertex: read_mesh has welded those at one place.
std::size_t count_shells(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::size_t shells = mesh.positions.size();  // each has a triangle
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t other : {t[1], t[2]}) {
      const std::uint32_t a = root(t[0]), b = root(other);
      if (a == b) continue;
      parent[a] = b;
      --shells;
    }
  }
  return shells;
}

/// What is solid of it where a scene voxelises it, m^3; a hundred voxels along the longest side.
/// NaN: nothing.
double solid_volume_m3(const TriangleMesh& mesh, const Eigen::Vector3d& size_m, double& voxel_m) {
  constexpr double kAlong = 100.0;
  voxel_m = size_m.maxCoeff() / kAlong;
  const Eigen::Vector3i leaves =
      (((size_m / voxel_m).array() + 2.0) / kLeafEdge).ceil().cast<int>();
  try {
    const VoxelModel model = voxelise_mesh(mesh, VoxelGrid{leaves * kLeafEdge, voxel_m}, {});
    return static_cast<double>(model.solid_count()) * voxel_m * voxel_m * voxel_m;
  } catch (const InputError&) {
    return std::nan("");
  }
}

}  // namespace

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
  say("mesh             %zu triangles, %zu vertices\n", mesh.triangles.size(),
      mesh.positions.size());
  say("size             %.3f x %.3f x %.3f mm\n", size_mm.x(), size_mm.y(), size_mm.z());
  say("volume           %.3f mm3\n", volume_m3 * 1e9);
  say("open edges       %td%s\n", open, open == 0 ? " (closed)" : "");
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
  sides.reserve(edges.size());
  for (const auto& [a, b] : edges) sides.emplace_back(std::min(a, b), std::max(a, b));
  std::sort(sides.begin(), sides.end());
  std::size_t shared = 0;  // by more than two triangles
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    while (end < sides.size() && sides[end] == sides[i]) ++end;
    shared += end - i > 2 ? 1 : 0;
  }
  say("crowded edges    %zu of more than two triangles\n", shared);
  say("shells           %zu\n", count_shells(mesh));
  double voxel_m = 0.0;
  const double solid_m3 = solid_volume_m3(mesh, box.sizes().cast<double>(), voxel_m);
  if (std::isnan(solid_m3)) {
    say("solid            none by winding number: too open, or too thin\n");
  } else {
    say("solid            %.3f mm3 by winding number, in voxels of %.3g mm\n", solid_m3 * 1e9,
        voxel_m / kMillimetre);
  }
}

}  // namespace sulcus
