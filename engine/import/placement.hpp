#pragma once

#include <Eigen/Geometry>

#include "engine/scene/scene.hpp"

namespace sulcus {

/// World from file, for what comes out of a file: the centre of its box comes to the scene's
/// origin; there it is turned about x, then y, then z (axes of the world) and moved.
inline Eigen::Affine3d placement(const Eigen::Vector3d& box_centre_file,
                                 const WorkpieceSettings& settings) {
  return Eigen::Translation3d(settings.position_m) *
         Eigen::AngleAxisd(settings.rotation.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(settings.rotation.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(settings.rotation.x(), Eigen::Vector3d::UnitX()) *
         Eigen::Translation3d(-box_centre_file);
}

}  // namespace sulcus
