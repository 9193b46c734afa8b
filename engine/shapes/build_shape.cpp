#include "engine/shapes/build_shape.hpp"

#include <array>
#include <string_view>

#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/molar.hpp"
#include "engine/shapes/voxelise_implicit.hpp"

namespace sulcus {

namespace {

/// Place of a tissue in the scene by name, or of what stands for it.
std::uint8_t label_of(const Scene& scene, std::initializer_list<std::string_view> names) {
  for (std::string_view name : names) {
    for (std::size_t i = 0; i < scene.tissues.size(); ++i) {
      if (scene.tissues[i].name == name) return static_cast<std::uint8_t>(i);
    }
  }
  return 0;
}

/// Labels of the parts, in the order of Part.
std::array<std::uint8_t, 4> part_labels(const Scene& scene) {
  return {label_of(scene, {"enamel"}), label_of(scene, {"dentine", "enamel"}),
          label_of(scene, {"pulp", "dentine", "enamel"}),
          label_of(scene, {"caries", "dentine", "enamel"})};
}

template <ImplicitShape S>
VoxelModel voxelise_shape(const Scene& scene, const S& shape) {
  const VoxelGrid grid{scene.workpiece.cells, scene.workpiece.voxel_m};
  const std::array<std::uint8_t, 4> labels = part_labels(scene);
  return voxelise_implicit(shape, grid, scene.tissues.size() > 1 ? &labels : nullptr,
                           {scene.workpiece.position_m, rotation_xyz(scene.workpiece.rotation)},
                           scene.workpiece.surface);
}

}  // namespace

VoxelModel build_shape(const Scene& scene) {
  const WorkpieceSettings& w = scene.workpiece;
  switch (*w.shape) {
    case ShapeKind::kMolar:
      return voxelise_shape(scene, Molar(w.molar_caries_radius_m));
    case ShapeKind::kSphere:
      return voxelise_shape(scene, SphereShape(w.sphere_radius_m));
    case ShapeKind::kBox:
      return voxelise_shape(scene, BoxShape(w.box_size_m));
    case ShapeKind::kPlate:
      return voxelise_shape(scene, PlateShape(w.plate_thickness_m, w.plate_tilt));
    case ShapeKind::kTorus:
      return voxelise_shape(scene, TorusShape(w.torus_major_m, w.torus_minor_m));
    case ShapeKind::kGroove:
      break;
  }
  return voxelise_shape(scene, GrooveShape(w.groove_angle, w.groove_depth_m));
}

}  // namespace sulcus
