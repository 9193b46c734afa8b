#pragma once

#include <vector>

#include "engine/graphics/rendered_body.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The workpiece and the other bodies of a scene, as the renderer takes them.
std::vector<RenderedBody> rendered_bodies(const Scene& scene, VoxelModel workpiece,
                                          std::vector<VoxelModel> bodies);

}  // namespace sulcus
