#include <utility>

#include "engine/core/error.hpp"
#include "haptics/c/scene_parts.hpp"
#include "haptics/start_place.hpp"

#ifdef SULCUS_WITHOUT_IMPORT
#include "engine/shapes/build_shape.hpp"
#else
#include "engine/import/build_workpiece.hpp"
#include "engine/import/load_burr.hpp"
#endif

namespace sulcus {

namespace {

#ifdef SULCUS_WITHOUT_IMPORT

/// Built-in shapes alone.
void refuse_file(const Scene& scene, const std::string& place, const std::string& file) {
  if (file.empty()) return;
  throw InputError(scene.file, place, file, "a built-in shape: this build reads no such files");
}

Burr burr_of(const Scene& scene, LoadCache*) {
  refuse_file(scene, "[burr] file", scene.burr.file);
  return make_burr(scene.burr, scene.workpiece.voxel_m, scene.file);
}

VoxelModel workpiece_of(const Scene& scene, LoadCache*) {
  refuse_file(scene, "[workpiece] file", scene.workpiece.file);
  return build_shape(scene);
}

std::vector<VoxelModel> bodies_of(const Scene& scene, LoadCache*) {
  std::vector<VoxelModel> models;
  for (const BodySettings& body : scene.bodies) {
    refuse_file(scene, "[[body]] '" + body.name + "' file", body.solid.file);
    Scene alone;
    alone.file = scene.file;
    alone.workpiece = body.solid;
    alone.tissues = scene.tissues;
    if (body.tissue) alone.tissues = {scene.tissues[*body.tissue]};
    models.push_back(build_shape(alone));
  }
  return models;
}

#else

Burr burr_of(const Scene& scene, LoadCache* cache) { return load_burr(scene, cache); }
VoxelModel workpiece_of(const Scene& scene, LoadCache* cache) {
  return build_workpiece(scene, cache);
}
std::vector<VoxelModel> bodies_of(const Scene& scene, LoadCache* cache) {
  return build_bodies(scene, cache);
}

#endif

}  // namespace

SceneParts load_parts(const Scene& scene, std::optional<VoxelModel> own, LoadCache* cache) {
  if (!scene.trajectory.recording.empty()) {
    throw InputError(scene.file, "[trajectory] recording", "a recording",
                     "points or a table of poses: recordings are read by the program");
  }
  Trajectory trajectory = scene_path(scene, scene.limits);
  Burr burr = burr_of(scene, cache);
  VoxelModel workpiece = own ? std::move(*own) : workpiece_of(scene, cache);
  std::vector<VoxelModel> bodies = bodies_of(scene, cache);
  check_start(scene, workpiece, bodies, burr, trajectory.pose_at(0.0));
  return {std::move(burr), std::move(workpiece), std::move(bodies), std::move(trajectory)};
}

}  // namespace sulcus
