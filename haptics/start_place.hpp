#pragma once

#include <span>

#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Refuses (InputError) a tool that starts with its head's middle inside the workpiece or another
/// body: only surface voxels are tested, so it would feel nothing. `bodies`: those of the scene
/// beside the workpiece, in its order.
void check_start(const Scene& scene, const VoxelModel& model, std::span<const VoxelModel> bodies,
                 const Burr& burr, const Pose& start);

}  // namespace sulcus
