#include "engine/import/build_workpiece.hpp"

#include "engine/core/error.hpp"
#include "engine/import/medical_volume.hpp"
#include "engine/import/mesh_file.hpp"
#include "engine/import/voxelise_mesh.hpp"
#include "engine/import/voxelise_volume.hpp"
#include "engine/shapes/build_shape.hpp"

namespace sulcus {

VoxelModel build_workpiece(const Scene& scene) {
  const WorkpieceSettings& w = scene.workpiece;
  const VoxelGrid grid{w.cells, w.voxel_m};
  VoxelModel model = w.shape ? build_shape(scene)
                     : is_mesh_file(w.file)
                         ? voxelise_mesh(read_mesh(w.file), grid, w)
                         : voxelise_volume(read_medical_volume(w.file), grid, w, scene.tissues);
  if (model.solid_count() == 0) {
    throw InputError(scene.file, "[workpiece]", "no solid voxel in the grid",
                     "a solid that reaches into it");
  }
  return model;
}

}  // namespace sulcus
