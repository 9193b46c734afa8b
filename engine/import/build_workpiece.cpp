#include "engine/import/build_workpiece.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/cache/cached_model.hpp"
#include "engine/core/error.hpp"
#include "engine/import/input_files.hpp"
#include "engine/import/medical_volume.hpp"
#include "engine/import/mesh_file.hpp"
#include "engine/import/voxelise_mesh.hpp"
#include "engine/import/voxelise_volume.hpp"
#include "engine/shapes/build_shape.hpp"

namespace sulcus {
namespace {

/// The meshes of the workpiece and of the tissues that have one.
VoxelModel voxelise_meshes(const Scene& scene, const VoxelGrid& grid) {
  InputLimits left = scene.limits;  // they are all held at once
  std::vector<TissueSurface> surfaces;
  const auto add = [&](const std::string& file, std::size_t tissue) {
    surfaces.push_back({read_mesh(file, left), file, static_cast<std::uint8_t>(tissue)});
    left.memory_bytes -= std::min<std::uint64_t>(
        left.memory_bytes, surfaces.back().mesh.triangles.size() * InputLimits::kTriangleBytes);
  };
  add(scene.workpiece.file, 0);
  for (std::size_t t = 1; t < scene.tissues.size(); ++t) {
    if (!scene.tissues[t].file.empty()) add(scene.tissues[t].file, t);
  }
  return voxelise_surfaces(surfaces, grid, scene.workpiece);
}

VoxelModel make_model(const Scene& scene, std::string_view place, const VoxelGrid& grid) {
  const WorkpieceSettings& w = scene.workpiece;
  VoxelModel model =
      w.shape ? build_shape(scene)
      : is_mesh_file(w.file)
          ? voxelise_meshes(scene, grid)
          : voxelise_volume(read_medical_volume(w.file, scene.limits), grid, w, scene.tissues);
  const bool solid =
      std::ranges::any_of(model.leaves, [](const LeafBits& leaf) { return any(leaf); });
  if (!solid) {
    throw InputError(scene.file, place, "no solid voxel in the grid",
                     "a solid that reaches into it");
  }
  return model;
}

/// All that the model follows from; empty where the input cannot be told by its contents.
std::optional<Hash128> key_of(const Scene& scene) {
  // A setting that is added does not compile until it has a place here.
  const auto& [shape, file, sphere_radius_m, box_size_m, plate_thickness_m, plate_tilt,
               torus_major_m, torus_minor_m, groove_angle, groove_depth_m, molar_caries_radius_m,
               solid_above, spacing_m, voxel_m, cells, position_m, rotation] = scene.workpiece;
  Hash128Stream key = LoadCache::key_of(CacheKind::kModel);
  key.add(shape);
  if (shape) {
    key.add(sphere_radius_m).add(box_size_m).add(plate_thickness_m).add(plate_tilt);
    key.add(torus_major_m).add(torus_minor_m).add(groove_angle).add(groove_depth_m);
    key.add(molar_caries_radius_m);
  } else {
    const std::optional<Hash128> contents = hash_input(file);
    if (!contents) return std::nullopt;
    key.add(*contents).add(solid_above).add(spacing_m);
  }
  key.add(voxel_m).add(cells).add(position_m).add(rotation);
  for (const TissueSettings& tissue : scene.tissues) {
    const auto& [name, above, surface_file, stiffness, specific_energy, colour] = tissue;
    key.add(name).add(above).add(!surface_file.empty());
    if (surface_file.empty()) continue;
    const std::optional<Hash128> contents = hash_input(surface_file);
    if (!contents) return std::nullopt;
    key.add(*contents);
  }
  return key.result();
}

/// `place`: the table of `scene.workpiece` in the file, for messages.
VoxelModel build(const Scene& scene, std::string_view place, LoadCache* cache) {
  const VoxelGrid grid{scene.workpiece.cells, scene.workpiece.voxel_m};
  const std::optional<Hash128> key =
      cache && cache->keeps() ? key_of(scene) : std::optional<Hash128>();
  if (key) {
    if (auto model = read_cached_model(*cache, *key, grid, scene.tissues.size())) {
      return std::move(*model);
    }
  }
  VoxelModel model = make_model(scene, place, grid);
  // The file may have been written to since its contents were hashed.
  if (key && (scene.workpiece.shape || key_of(scene) == key)) {
    write_cached_model(*cache, *key, model);
  }
  return model;
}

}  // namespace

VoxelModel build_workpiece(const Scene& scene, LoadCache* cache) {
  return build(scene, "[workpiece]", cache);
}

std::vector<VoxelModel> build_bodies(const Scene& scene, LoadCache* cache) {
  std::vector<VoxelModel> models;
  for (const BodySettings& body : scene.bodies) {
    Scene alone;
    alone.file = scene.file;
    alone.limits = scene.limits;
    alone.workpiece = body.solid;
    alone.tissues = scene.tissues;
    if (body.tissue) alone.tissues = {scene.tissues[*body.tissue]};
    for (TissueSettings& tissue : alone.tissues) tissue.file.clear();  // of the workpiece
    models.push_back(build(alone, "[[body]] '" + body.name + "'", cache));
  }
  return models;
}

std::optional<VoxelModel> build_goal(const Scene& scene, LoadCache* cache) {
  if (!scene.goal || scene.goal->shape != GoalShape::kFile) return {};
  Scene alone;
  alone.file = scene.file;
  alone.limits = scene.limits;
  alone.tissues = {scene.tissues.front()};
  WorkpieceSettings& solid = alone.workpiece;
  solid.file = scene.goal->file;
  solid.solid_above = scene.goal->solid_above;
  solid.position_m = scene.goal->position_m;
  solid.rotation = scene.goal->rotation;
  solid.voxel_m = scene.workpiece.voxel_m;
  solid.cells = scene.workpiece.cells;
  return build(alone, "[goal]", cache);
}

}  // namespace sulcus
