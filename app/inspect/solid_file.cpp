#include "app/inspect/solid_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/inspect/mesh_facts.hpp"
#include "engine/core/error.hpp"
#include "engine/core/file_kind.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "engine/import/volumes/voxelise_volume.hpp"
#include "engine/scene/scene.hpp"
#include "engine/surface/surface_mesh.hpp"

namespace sulcus {

namespace {

/// Facing outwards, whichever way round its triangles are in the file.
TriangleMesh closed_mesh(const std::string& path, const std::string& option) {
  TriangleMesh mesh = read_mesh(path);
  const MeshFacts facts = mesh_facts(mesh);
  if (facts.open_edges > 0) {
    throw InputError(path, option,
                     "a surface with holes (open edges: " + std::to_string(facts.open_edges) + ")",
                     "a closed one");
  }
  if (facts.volume_m3 < 0.0) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

bool is_mask(const MedicalVolume& volume) {
  constexpr float kMostLabel = 255.0f;
  return std::ranges::all_of(volume.values, [](float value) {
    return value >= 0.0f && value <= kMostLabel && value == std::floor(value);
  });
}

/// Cubes, of which as many as hold all of the volume about the middle of whatever is solid in it.
VoxelGrid grid_for(const MedicalVolume& volume, const std::string& option) {
  const double voxel_m = volume.spacing_m.minCoeff();
  VoxelGrid grid{Eigen::Vector3i::Zero(), voxel_m};
  for (int axis = 0; axis < 3; ++axis) {
    // Along its own axes, and along those of space, however it lies in it.
    double box_m = 0.0;
    for (int along = 0; along < 3; ++along) {
      box_m +=
          std::abs(volume.direction(axis, along)) * volume.sizes[along] * volume.spacing_m[along];
    }
    const double extent_m = std::max(box_m, volume.sizes[axis] * volume.spacing_m[axis]);
    const double cells = std::ceil(extent_m / voxel_m) + 4.0;
    if (!(cells <= kMaxCellsPerAxis)) {
      throw InputError(volume.file, option, std::to_string(static_cast<long>(cells)) + " voxels",
                       "at most " + std::to_string(kMaxCellsPerAxis) + " along an axis");
    }
    grid.cells[axis] = (static_cast<int>(cells) + kLeafEdge - 1) / kLeafEdge * kLeafEdge;
  }
  return grid;
}

}  // namespace

TriangleMesh surface_of_file(const std::string& path, std::optional<double> solid_above,
                             const std::string& option) {
  if (is_mesh_file(path)) return closed_mesh(path, option);
  const MedicalVolume volume = read_medical_volume(path);
  if (!solid_above && !is_mask(volume)) {
    throw InputError(path, option, "grey values", "--solid-above VALUE, from which they are tooth");
  }
  WorkpieceSettings settings;
  settings.file = path;
  settings.solid_above = solid_above;
  settings.surface = solid_above ? SurfaceKind::kFractions : SurfaceKind::kBinary;
  const std::array<TissueSettings, 1> tooth{TissueSettings{.name = "tooth", .above = {}}};
  VolumeImportReport report;
  const VoxelModel model =
      voxelise_volume(volume, grid_for(volume, option), settings, tooth, &report);
  TriangleMesh mesh = closed_surface(model);
  transform(report.file_from_world, mesh);
  return mesh;
}

}  // namespace sulcus
