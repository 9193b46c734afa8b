#include "engine/graphics/view_place.hpp"

namespace sulcus {

// The second row of the matrix is `up` over the slope, the fourth the depth.

double slope_of(const View& view) {
  return 1.0 / view.clip_from_world.row(1).head<3>().cast<double>().norm();
}

double depth_of(const View& view, const Eigen::Vector3d& p_world) {
  return (view.eye_world.cast<double>() - p_world).dot(view.back_world.cast<double>());
}

SightLine sight_line(const View& view, const Eigen::Vector2d& place) {
  const double slope = slope_of(view);
  const Eigen::Vector3d way = slope * place.x() * view.right_world.cast<double>() +
                              slope * place.y() * view.up_world.cast<double>() -
                              view.back_world.cast<double>();
  return {view.eye_world.cast<double>(), way.normalized()};
}

std::optional<Eigen::Vector2d> place_of(const View& view, const Eigen::Vector3d& p_world) {
  const double depth = depth_of(view, p_world);
  if (depth <= 0.0) return {};
  const Eigen::Vector3d from_eye = p_world - view.eye_world.cast<double>();
  return Eigen::Vector2d(from_eye.dot(view.right_world.cast<double>()),
                         from_eye.dot(view.up_world.cast<double>())) /
         (slope_of(view) * depth);
}

LookAt look_at_of(const View& view, int height) {
  const double distance = 0.5 * height * view.metres_per_pixel / slope_of(view);
  return {view.eye_world.cast<double>() - distance * view.back_world.cast<double>(), distance};
}

}  // namespace sulcus
