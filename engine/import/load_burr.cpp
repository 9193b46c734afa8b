#include "engine/import/load_burr.hpp"

#include "engine/import/mesh_file.hpp"
#include "engine/tool/burr_mesh.hpp"

namespace sulcus {

Burr load_burr(const Scene& scene) {
  const double voxel_m = scene.workpiece.voxel_m;
  if (scene.burr.shape != BurrShape::kFile) return make_burr(scene.burr, voxel_m, scene.file);
  return make_burr(scene.burr, voxel_m, tool_from_file(read_mesh(scene.burr.file)), scene.file);
}

}  // namespace sulcus
