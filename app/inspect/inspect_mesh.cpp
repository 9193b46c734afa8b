#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "app/inspect/inspect.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/meshes/mesh_shells.hpp"
#include "engine/import/meshes/voxelise_mesh.hpp"
#include "engine/volume/filled_volume.hpp"

namespace sulcus {

namespace {

/// What is solid of it where a scene voxelises it, in a hundred voxels along the longest side.
void print_solid(const TriangleMesh& mesh, const MeshShells& shells) {
  const auto [grid, positions_index] = lattice_about(mesh);
  if (const auto conflict = find_shell_conflict(mesh, shells, grid, positions_index)) {
    say("solid            not clear: %s\n",
        describe(*conflict, mesh, shells, grid.voxel_m).c_str());
    return;
  }
  try {
    WorkpieceSettings settings;
    settings.surface = SurfaceKind::kFractions;
    const VoxelModel model = voxelise_mesh(mesh, grid, settings);
    say("solid            %.3f mm3 by winding number, in voxels of %.3g mm\n",
        filled_voxels(model) * model.grid.voxel_volume_m3() * 1e9, grid.voxel_m / kMillimetre);
  } catch (const InputError&) {
    say("solid            none by winding number: too open, or too thin\n");
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
  // Of a tooth in metres; none in mm is as small.
  constexpr double kSmall_mm = 0.3;
  say("size             %.3f x %.3f x %.3f mm%s\n", size_mm.x(), size_mm.y(), size_mm.z(),
      size_mm.maxCoeff() < kSmall_mm ? ", as mm: is the file in metres?" : "");
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
  const MeshShells shells = find_shells(mesh);
  say("shells           %zu\n", shells.count);
  print_solid(mesh, shells);
}

}  // namespace sulcus
