#pragma once

#include <Eigen/Geometry>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// World from file, for what comes out of a file: the centre of its box comes to the scene's
/// origin; there it is turned about x, then y, then z (axes of the world) and moved.
inline Eigen::Affine3d placement(const Eigen::Vector3d& box_centre_file,
                                 const WorkpieceSettings& settings) {
  return Eigen::Translation3d(settings.position_m) * rotation_xyz(settings.rotation) *
         Eigen::Translation3d(-box_centre_file);
}

}  // namespace sulcus
