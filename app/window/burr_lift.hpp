#pragma once

#include <optional>

#include "engine/core/pose.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The least distance from the cutting head of a burr to the centre of a solid voxel, m, below 0
/// inside; `most_m` where it is larger. By the burr's field, which beyond its box gives up to a
/// tenth too much. `tool`: in the space of the model's grid.
double room_round(const VoxelModel& model, const Burr& burr, const Pose& tool, double most_m);

/// The pose to which a burr is drawn back from a tooth that it may touch: along its axis, or where
/// something is in the way there, across it, without going into the solid, until a gap of
/// `clearance_m` is between them. That of the tool where there is one already; none where no way
/// leads out. Walks the leaves of the model once for each way that is tried.
std::optional<Pose> drawn_back(const VoxelModel& model, const Burr& burr, const Pose& tool,
                               double clearance_m);

}  // namespace sulcus
