#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/graphics/view_place.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// A point of a body that is seen.
struct PickedPoint {
  Eigen::Vector3d point_world;
  Cell cell;            // the voxel that it is on
  std::uint8_t tissue;  // its label
  double distance_m;    // from the eye
};

/// The point of a body that a line of sight meets first: where it enters a solid voxel, of those
/// with fractions one that is at least half full. The drawn surface is smoothed, and within a voxel
/// of it. `shown_world`: as View has it, what a section leaves of the body; where the line enters
/// that inside of the solid it is on the section's face. Any thread, while nothing is removed; some
/// microseconds.
std::optional<PickedPoint> picked_point(const VoxelModel& model, const Pose& world_from_grid,
                                        const SightLine& line, const Eigen::Vector4f& shown_world);

}  // namespace sulcus
