#pragma once

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Whether a point of the world lies in a solid voxel of a body, whose grid lies at a pose.
bool is_inside(const VoxelModel& body, const Pose& world_from_grid,
               const Eigen::Vector3d& point_world) noexcept;

/// Whether a point that goes straight from one place to another, further than half a voxel, comes
/// through a body or ends in it. Looked at every half voxel: no voxel of a wall that is crossed
/// straight on is missed. One that begins in the body does not come through it.
bool goes_through(const VoxelModel& body, const Pose& world_from_grid,
                  const Eigen::Vector3d& from_world, const Eigen::Vector3d& to_world) noexcept;

}  // namespace sulcus
