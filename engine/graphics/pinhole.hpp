#pragma once

#include <Eigen/Core>

#include "engine/graphics/camera.hpp"

namespace sulcus {

/// A camera as computer vision has it. Camera space: x right, y down, z along the optical axis.
/// (u, v) = (f x / z + c) with (0, 0) in the middle of the upper left pixel; pixels are square.
struct Pinhole {
  double focal_pixels = 0.0;
  Eigen::Vector2d centre_pixels = Eigen::Vector2d::Zero();
  double near_m = 0.0, far_m = 0.0;                                 // depths that are drawn
  Eigen::Matrix4d world_from_camera = Eigen::Matrix4d::Identity();  // of points, m

  /// The point that is seen at a pixel at a depth along the optical axis; camera space, m.
  Eigen::Vector3d point_camera(double u, double v, double depth_m) const {
    return {(u - centre_pixels.x()) / focal_pixels * depth_m,
            (v - centre_pixels.y()) / focal_pixels * depth_m, depth_m};
  }
  Eigen::Vector3d point_world(double u, double v, double depth_m) const {
    return world_from_camera.topLeftCorner<3, 3>() * point_camera(u, v, depth_m) +
           world_from_camera.topRightCorner<3, 1>();
  }
};

/// That of a view in a picture of so many pixels. All our cameras are in perspective.
Pinhole pinhole_of(const View& view, int width, int height);

}  // namespace sulcus
