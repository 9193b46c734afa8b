#pragma once

#include <optional>

#include <Eigen/Core>

#include "engine/graphics/camera.hpp"

namespace sulcus {

// Places in a picture, and what of the world they show. A place is right and up from the middle, in
// half heights of the picture: it needs no size in pixels, but for the width where it ends.

/// From the eye through a place of the picture.
struct SightLine {
  Eigen::Vector3d from_world, way_world;  // `way_world`: unit
};
SightLine sight_line(const View& view, const Eigen::Vector2d& place);

/// Where a point is seen; none of one that is not before the eye.
std::optional<Eigen::Vector2d> place_of(const View& view, const Eigen::Vector3d& p_world);

/// How far before the eye a point lies, along the direction in which the camera looks, m.
double depth_of(const View& view, const Eigen::Vector3d& p_world);

/// Half the height of what is seen 1 m before the eye, m.
double slope_of(const View& view);

/// What the camera looks at, in a picture of this height in pixels.
LookAt look_at_of(const View& view, int height);

}  // namespace sulcus
