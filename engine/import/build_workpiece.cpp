#include "engine/import/build_workpiece.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/cache/cached_model.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/input_files.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/meshes/mesh_size.hpp"
#include "engine/import/meshes/voxelise_mesh.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "engine/import/volumes/volume_part.hpp"
#include "engine/import/volumes/voxelise_volume.hpp"
#include "engine/shapes/build_shape.hpp"

namespace sulcus {
namespace {

constexpr std::string_view kWorkpiecePlace = "[workpiece]";

/// Says where what is to be cut is as large as no tooth, as a file in another unit is.
void warn_of_size(std::span<const TissueSurface> surfaces, const WorkpieceSettings& settings,
                  ImportNotes& notes) {
  const std::string doubt = doubt_size(longest_side_m(surfaces), settings.unit);
  if (!doubt.empty()) notes.warnings.push_back("the mesh is " + doubt);
}

/// The meshes of the workpiece and of the tissues that have one.
VoxelModel import_meshes(const Scene& scene, std::string_view place, const VoxelGrid& grid,
                         ImportNotes& notes) {
  InputLimits left = scene.limits;  // they are all held at once
  std::vector<TissueSurface> surfaces;
  const auto add = [&](const std::string& file, std::size_t tissue) {
    surfaces.push_back({read_mesh(file, left, metres_of(scene.workpiece.unit)), file,
                        static_cast<std::uint8_t>(tissue)});
    left.memory_bytes -= std::min<std::uint64_t>(
        left.memory_bytes, surfaces.back().mesh.triangles.size() * InputLimits::kTriangleBytes);
  };
  add(scene.workpiece.file, 0);
  for (std::size_t t = 1; t < scene.tissues.size(); ++t) {
    if (!scene.tissues[t].file.empty()) add(scene.tissues[t].file, t);
  }
  if (place == kWorkpiecePlace) warn_of_size(surfaces, scene.workpiece, notes);
  notes.input.emplace().file_from_world = world_from_surfaces(surfaces, scene.workpiece).inverse();
  return voxelise_surfaces(surfaces, grid, scene.workpiece);
}

/// Says where a solid lies that is not where the scene puts it.
void warn_of_place(const VolumeImportReport& report, const WorkpieceSettings& settings,
                   ImportNotes& notes) {
  constexpr double kSeen = 0.01;  // of a voxel
  const Eigen::Vector3d beside_mm = report.beside_m / kMillimetre;
  if (report.beside_m.cwiseAbs().maxCoeff() < kSeen * settings.voxel_m) return;
  std::ostringstream text;
  text.precision(4);
  text
      << "the solid lies (" << beside_mm.x() << ", " << beside_mm.y() << ", " << beside_mm.z()
      << ") mm beside where position_mm puts its middle, so that its voxels stay those of the file";
  notes.warnings.push_back(text.str());
}

VoxelModel import_volume(const Scene& scene, const VoxelGrid& grid, ImportNotes& notes) {
  const WorkpieceSettings& w = scene.workpiece;
  MedicalVolume volume = read_medical_volume(w.file, scene.limits);
  InputGeometry input;
  input.sizes = volume.sizes;
  input.spacing_m = w.spacing_m.value_or(volume.spacing_m);
  input.origin_m = volume.origin_m;
  input.direction = volume.direction;
  notes.warnings = volume.warnings;
  std::optional<MedicalVolume> labels;
  if (!w.labels.empty()) {
    labels = read_medical_volume(w.labels, scene.limits);
    for (const std::string& warning : labels->warnings) {
      notes.warnings.push_back("labels: " + warning);
    }
  }
  volume =
      take_part(std::move(volume), labels ? &*labels : nullptr, w, scene.tissues, notes.warnings);
  VolumeImportReport report;
  VoxelModel model = voxelise_volume(volume, grid, w, scene.tissues, &report);
  warn_of_place(report, w, notes);
  input.file_from_world = report.file_from_world;
  notes.input = input;
  return model;
}

/// What of the tissues is of no use without grey values.
void warn_of_greys(const std::vector<TissueSettings>& tissues, ImportNotes& notes) {
  for (const TissueSettings& tissue : tissues) {
    if (!tissue.above) continue;
    notes.warnings.push_back("above of the tissue '" + tissue.name +
                             "' has no effect: the workpiece is no volume of grey values");
  }
}

/// Refuses keys of volumes beside a shape or a mesh, where they would do nothing.
void check_volume_keys(const Scene& scene, std::string_view place) {
  const WorkpieceSettings& w = scene.workpiece;
  if (!w.shape && !is_mesh_file(w.file)) return;
  const char* const key = w.box_file      ? "box_mm"
                          : w.label       ? "label"
                          : w.solid_above ? "solid_above"
                          : w.spacing_m   ? "spacing_mm"
                                          : nullptr;
  if (!key) return;
  throw InputError(scene.file, place,
                   std::string(key) + (w.shape ? " for a built-in shape" : " for a mesh"),
                   "it beside a volume");
}

VoxelModel make_model(const Scene& scene, std::string_view place, const VoxelGrid& grid,
                      ImportNotes& notes) {
  const WorkpieceSettings& w = scene.workpiece;
  const bool mesh = !w.shape && is_mesh_file(w.file);
  if (w.shape || mesh) warn_of_greys(scene.tissues, notes);
  VoxelModel model = w.shape ? build_shape(scene)
                     : mesh  ? import_meshes(scene, place, grid, notes)
                             : import_volume(scene, grid, notes);
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
               solid_above, spacing_m, box_file, labels, label, surface, voxel_m, cells, position_m,
               rotation, unit] = scene.workpiece;
  Hash128Stream key = LoadCache::key_of(CacheKind::kModel);
  key.add(shape);
  if (shape) {
    key.add(sphere_radius_m).add(box_size_m).add(plate_thickness_m).add(plate_tilt);
    key.add(torus_major_m).add(torus_minor_m).add(groove_angle).add(groove_depth_m);
    key.add(molar_caries_radius_m);
  } else {
    const std::optional<Hash128> contents = hash_input(file);
    if (!contents) return std::nullopt;
    key.add(*contents).add(unit).add(solid_above).add(spacing_m).add(label);
    key.add(box_file.has_value());
    if (box_file) {
      const Eigen::Vector3d low = box_file->min(), high = box_file->max();
      key.add(low).add(high);
    }
    key.add(!labels.empty());
    if (!labels.empty()) {
      const std::optional<Hash128> label_contents = hash_input(labels);
      if (!label_contents) return std::nullopt;
      key.add(*label_contents);
    }
  }
  key.add(surface).add(voxel_m).add(cells).add(position_m).add(rotation);
  for (const TissueSettings& tissue : scene.tissues) {
    const auto& [name, above, value, surface_file, stiffness, specific_energy, colour] = tissue;
    key.add(name).add(above).add(value).add(!surface_file.empty());
    if (surface_file.empty()) continue;
    const std::optional<Hash128> contents = hash_input(surface_file);
    if (!contents) return std::nullopt;
    key.add(*contents);
  }
  return key.result();
}

/// A tissue that a solid is made of whatever its file says: no part of that is looked for.
TissueSettings all_of(TissueSettings tissue) {
  tissue.label.reset();
  return tissue;
}

/// `place`: the table of `scene.workpiece` in the file, for messages.
VoxelModel build(const Scene& scene, std::string_view place, LoadCache* cache,
                 ImportNotes* wanted = nullptr) {
  check_volume_keys(scene, place);
  const VoxelGrid grid{scene.workpiece.cells, scene.workpiece.voxel_m};
  const std::optional<Hash128> key =
      cache && cache->keeps() ? key_of(scene) : std::optional<Hash128>();
  if (key) {
    if (auto model = read_cached_model(*cache, *key, grid, scene.tissues.size(), wanted)) {
      return std::move(*model);
    }
  }
  ImportNotes notes;
  VoxelModel model = make_model(scene, place, grid, notes);
  // The file may have been written to since its contents were hashed.
  if (key && (scene.workpiece.shape || key_of(scene) == key)) {
    write_cached_model(*cache, *key, model, notes);
  }
  if (wanted) *wanted = std::move(notes);
  return model;
}

/// The same of a solid beside the workpiece.
VoxelModel build_beside(const Scene& alone, const std::string& place, LoadCache* cache,
                        std::vector<std::string>* warnings) {
  ImportNotes notes;
  VoxelModel model = build(alone, place, cache, &notes);
  if (warnings) {
    for (const std::string& warning : notes.warnings) warnings->push_back(place + ": " + warning);
  }
  return model;
}

}  // namespace

VoxelModel build_workpiece(const Scene& scene, LoadCache* cache, ImportNotes* notes) {
  return build(scene, kWorkpiecePlace, cache, notes);
}

std::vector<VoxelModel> build_bodies(const Scene& scene, LoadCache* cache,
                                     std::vector<std::string>* warnings) {
  std::vector<VoxelModel> models;
  for (const BodySettings& body : scene.bodies) {
    Scene alone;
    alone.file = scene.file;
    alone.limits = scene.limits;
    alone.workpiece = body.solid;
    alone.tissues = scene.tissues;
    if (body.tissue) alone.tissues = {all_of(scene.tissues[*body.tissue])};
    for (TissueSettings& tissue : alone.tissues) tissue.file.clear();  // of the workpiece
    models.push_back(build_beside(alone, "[[body]] '" + body.name + "'", cache, warnings));
  }
  return models;
}

std::optional<VoxelModel> build_goal(const Scene& scene, LoadCache* cache,
                                     std::vector<std::string>* warnings) {
  if (!scene.goal || scene.goal->shape != GoalShape::kFile) return {};
  Scene alone;
  alone.file = scene.file;
  alone.limits = scene.limits;
  alone.tissues = {all_of(scene.tissues.front())};
  WorkpieceSettings& solid = alone.workpiece;
  solid.file = scene.goal->file;
  solid.unit = scene.goal->unit;
  solid.solid_above = scene.goal->solid_above;
  solid.position_m = scene.goal->position_m;
  solid.rotation = scene.goal->rotation;
  solid.voxel_m = scene.workpiece.voxel_m;
  solid.cells = scene.workpiece.cells;
  return build_beside(alone, "[goal]", cache, warnings);
}

}  // namespace sulcus
