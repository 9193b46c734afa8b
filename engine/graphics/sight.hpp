#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/pose.hpp"
#include "engine/graphics/camera.hpp"

namespace sulcus {

/// Points, world, m, that a picture from there is to show: spread through the upper half of what is
/// solid at the start, where a tooth has its crown and is prepared; of one that follows the burr,
/// its tip alone. `solid_world`: its boxes, as of make_view; none: no points.
std::vector<Eigen::Vector3d> points_to_see(const Viewpoint& from,
                                           std::span<const Eigen::AlignedBox3d> solid_world,
                                           const Eigen::Vector3d& tip_world);

/// The share, 0 to 1, of the points to which the straight line from the eye meets one of a body's
/// boxes; 0 where there are no points. A point inside a box is not counted: there the body is round
/// it, as a jaw is round a root or a tooth round the burr that cuts it, and not before it.
/// `boxes_grid`: they hold what is solid of the body, in its own space, which stands at
/// `world_from_grid`.
double hidden_share(const Eigen::Vector3d& eye_world, std::span<const Eigen::Vector3d> points_world,
                    std::span<const Eigen::AlignedBox3d> boxes_grid, const Pose& world_from_grid);

}  // namespace sulcus
