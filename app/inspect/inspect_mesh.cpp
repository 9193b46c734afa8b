#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "app/inspect/inspect.hpp"
#include "app/inspect/mesh_facts.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/meshes/mesh_shells.hpp"
#include "engine/import/meshes/mesh_size.hpp"
#include "engine/import/meshes/voxelise_mesh.hpp"
#include "engine/volume/filled_volume.hpp"

namespace sulcus {

namespace {

/// What is solid of it where a scene voxelises it, in a hundred voxels along the longest side.
/// Whether a scene takes it.
bool print_solid(const TriangleMesh& mesh, const MeshShells& shells) {
  const auto [grid, positions_index] = lattice_about(mesh);
  if (const auto conflict = find_shell_conflict(mesh, shells, grid, positions_index)) {
    say("solid            not clear: %s\n",
        describe(*conflict, mesh, shells, grid.voxel_m).c_str());
    return false;
  }
  try {
    WorkpieceSettings settings;
    settings.surface = SurfaceKind::kFractions;
    const VoxelModel model = voxelise_mesh(mesh, grid, settings);
    say("solid            %.3f mm3 by winding number, in voxels of %.3g mm\n",
        filled_voxels(model) * model.grid.voxel_volume_m3() * 1e9, grid.voxel_m / kMillimetre);
    return true;
  } catch (const InputError&) {
    say("solid            none by winding number: too open, or too thin\n");
    return false;
  }
}

/// A place, in millimetres.
std::string place_text(const Eigen::Vector3d& p_m) {
  std::array<double, 3> mm{};
  for (Eigen::Index a = 0; a < 3; ++a) {
    const double at = p_m[a] / kMillimetre;
    constexpr double kShown = 0.0005;
    mm[static_cast<std::size_t>(a)] = at < 0.0 && at > -kShown ? 0.0 : at;  // no "-0.000"
  }
  return formatted("(%.3f, %.3f, %.3f)", mm[0], mm[1], mm[2]);
}

void print_place(const MeshFacts& facts) {
  const Eigen::AlignedBox3d& box = facts.box_file_m;
  const Eigen::Vector3d size_mm = box.sizes() / kMillimetre;
  say("size             %.3f x %.3f x %.3f mm\n", size_mm.x(), size_mm.y(), size_mm.z());
  say("box in the file  %s to %s mm\n", place_text(box.min()).c_str(),
      place_text(box.max()).c_str());
  say("box in a scene   %s to %s mm: its middle comes to (0, 0, 0)\n",
      place_text(facts.scene_from_file(box.min())).c_str(),
      place_text(facts.scene_from_file(box.max())).c_str());
  say("highest place    %s mm in a scene\n", place_text(facts.highest_scene_m).c_str());
}

}  // namespace

void inspect_mesh(const std::string& file, MeshUnit unit, const std::string& picture_png) {
  const TriangleMesh mesh = read_mesh(file, {}, metres_of(unit));
  const MeshFacts facts = mesh_facts(mesh);
  say("mesh             %zu triangles, %zu vertices\n", mesh.triangles.size(),
      mesh.positions.size());
  print_place(facts);
  say("volume           %.3f mm3\n", facts.volume_m3 * 1e9);
  say("open edges       %zu%s\n", facts.open_edges, facts.open_edges == 0 ? " (closed)" : "");
  say("non-manifold     %zu edges of more than two triangles\n", facts.non_manifold_edges);
  const MeshShells shells = find_shells(mesh);
  say("shells           %zu\n", shells.count);
  const bool solid = print_solid(mesh, shells);
  const std::string doubt = doubt_size(facts.box_file_m.sizes().maxCoeff(), unit);
  if (!doubt.empty()) {
    say("question         in what unit is the file? It is %s\n", doubt.c_str());
    say("to cut it        say its unit: --unit here, unit in a scene's [workpiece]\n");
  } else if (solid) {
    say("to cut it        %s\n", mesh_command(file, unit, facts).c_str());
  }
  if (picture_png.empty()) return;
  if (!draw_mesh(mesh, facts, std::filesystem::path(file).filename().string(), picture_png)) {
    throw std::runtime_error(picture_png + ": gnuplot could not draw it");
  }
}

}  // namespace sulcus
