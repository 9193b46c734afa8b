#pragma once

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Whether a point of the world lies in a solid voxel of a body, whose grid lies at a pose.
bool is_inside(const VoxelModel& body, const Pose& world_from_grid,
               const Eigen::Vector3d& point_world) noexcept;

/// What a point that went straight from one place to another met of a body.
struct WayThrough {
  bool ends_inside = false;
  bool crosses = false;  // solid in between, longer than half a voxel away from where it began
};
/// Looked at every half voxel; ways of up to half a voxel only where they end. No voxel of a wall
/// that is crossed straight on is missed.
WayThrough way_through(const VoxelModel& body, const Pose& world_from_grid,
                       const Eigen::Vector3d& from_world, const Eigen::Vector3d& to_world) noexcept;

}  // namespace sulcus
