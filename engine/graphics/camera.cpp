#include "engine/graphics/camera.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/units.hpp"

namespace sulcus {
namespace {

constexpr double kFieldOfView = 22.0 * kDegree;  // of the height: little perspective
constexpr double kFill = 0.93;                   // of the frame that the box takes
constexpr double kNearest = 0.5 * kMillimetre;   // nothing nearer to the eye is drawn

/// From the point looked at towards the eye. Crown +z, buccal -y, mesial +x.
Eigen::Vector3d towards_eye(Camera camera) {
  switch (camera) {
    case Camera::kReview:
      return Eigen::Vector3d(0.50, -0.72, 0.66).normalized();
    case Camera::kOcclusal:
      return Eigen::Vector3d::UnitZ();
    case Camera::kBuccal:
      return -Eigen::Vector3d::UnitY();
    case Camera::kMesial:
      return Eigen::Vector3d::UnitX();
    case Camera::kBurr:
      return Eigen::Vector3d(0.42, -0.66, 0.95).normalized();
  }
  return Eigen::Vector3d::UnitZ();
}

struct ViewAxes {
  Eigen::Vector3d right, up, back;
};

/// Moves `focus` to the middle of what is seen of the solid; how far from it the eye must be for
/// that to fill the frame.
double fill_frame(std::span<const Eigen::AlignedBox3d> solid_world, const ViewAxes& axes,
                  const Eigen::Vector2d& slopes, Eigen::Vector3d& focus) {
  double distance = 0.0;
  for (int pass = 0; pass < 2; ++pass) {
    double low = 0.0, high = 0.0;
    distance = 0.0;
    for (const Eigen::AlignedBox3d& part : solid_world) {
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d d =
            part.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - focus;
        low = std::min(low, d.dot(axes.up));
        high = std::max(high, d.dot(axes.up));
        const double x = std::abs(d.dot(axes.right)) / (slopes.x() * kFill);
        const double y = std::abs(d.dot(axes.up)) / (slopes.y() * kFill);
        distance = std::max(distance, d.dot(axes.back) + std::max(x, y));
      }
    }
    if (pass == 0) focus += 0.5 * (low + high) * axes.up;
  }
  return distance;
}

}  // namespace

Viewpoint::Viewpoint(Camera named)
    : back_world(towards_eye(named)),
      upright_world(named == Camera::kOcclusal ? Eigen::Vector3d::UnitY()
                                               : Eigen::Vector3d::UnitZ()),
      follows_burr(named == Camera::kBurr) {}

Viewpoint::Viewpoint(double azimuth_deg, double elevation_deg) {
  const double along = azimuth_deg * kDegree, up = elevation_deg * kDegree;
  const Eigen::Vector3d level(std::cos(along), std::sin(along), 0.0);
  back_world = std::cos(up) * level + std::sin(up) * Eigen::Vector3d::UnitZ();
  // Turned with it, so that straight from above is a view as well.
  upright_world = std::cos(up) * Eigen::Vector3d::UnitZ() - std::sin(up) * level;
}

View make_view(const Viewpoint& from, std::span<const Eigen::AlignedBox3d> solid_world,
               const Eigen::Vector3d& tip_world, double burr_radius_m, int width, int height,
               std::span<const Eigen::AlignedBox3d> others_world) {
  const Eigen::AlignedBox3d centimetre(Eigen::Vector3d::Constant(-5.0 * kMillimetre),
                                       Eigen::Vector3d::Constant(5.0 * kMillimetre));
  if (solid_world.empty()) solid_world = {&centimetre, 1};
  Eigen::AlignedBox3d box;
  for (const Eigen::AlignedBox3d& part : solid_world) box.extend(part);
  const Eigen::Vector3d& back = from.back_world;
  const Eigen::Vector3d right = from.upright_world.cross(back).normalized();
  const Eigen::Vector3d up = back.cross(right);
  const double aspect = static_cast<double>(width) / height;
  const double slope_y = std::tan(0.5 * kFieldOfView);
  const double slope_x = slope_y * aspect;

  Eigen::Vector3d focus = box.center();
  double distance = 0.0;
  if (from.look_at) {
    focus = from.look_at->point_world;
    distance = from.look_at->distance_m;
  } else if (from.follows_burr) {
    focus = tip_world + Eigen::Vector3d::UnitZ() * 0.5 * burr_radius_m;
    distance = std::max(1.5 * kMillimetre, 3.2 * burr_radius_m) / slope_y;
  } else {
    distance = fill_frame(solid_world, {right, up, back}, {slope_x, slope_y}, focus);
  }
  if (!from.look_at) {
    if (from.middle_world) focus = *from.middle_world;
    distance /= from.zoom;
    focus += slope_y * distance * (from.pan.x() * right + from.pan.y() * up);
  }
  const Eigen::Vector3d eye = focus + distance * back;
  // The burr's shank may reach far behind the box and towards the eye.
  double far = distance + box.diagonal().norm() + 60.0 * kMillimetre;
  double near = std::max(0.05 * distance, kNearest);
  for (const Eigen::AlignedBox3d& other : others_world) {
    if (other.isEmpty()) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p = other.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      const double depth = (eye - p).dot(back);
      far = std::max(far, 1.01 * depth);
      near = std::max(std::min(near, 0.99 * depth), kNearest);
    }
  }

  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.block<1, 3>(0, 0) = right.transpose();
  view.block<1, 3>(1, 0) = up.transpose();
  view.block<1, 3>(2, 0) = back.transpose();
  view.block<3, 1>(0, 3) = -view.block<3, 3>(0, 0) * eye;
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  clip(0, 0) = 1.0 / slope_x;
  clip(1, 1) = 1.0 / slope_y;
  clip(2, 2) = -(far + near) / (far - near);
  clip(2, 3) = -2.0 * far * near / (far - near);
  clip(3, 2) = -1.0;

  View result;
  result.clip_from_world = (clip * view).cast<float>();
  result.eye_world = eye.cast<float>();
  result.right_world = right.cast<float>();
  result.up_world = up.cast<float>();
  result.back_world = back.cast<float>();
  result.metres_per_pixel = 2.0 * slope_y * distance / height;
  result.focal_pixels = 0.5 * height / slope_y;
  result.near_m = near;
  result.far_m = far;
  return result;
}

View moved_right(const View& view, double by_m) {
  const Eigen::Vector3d step = by_m * view.right_world.cast<double>();
  const Eigen::Matrix4d back(Eigen::Affine3d(Eigen::Translation3d(-step)).matrix());
  View moved = view;
  moved.eye_world = (view.eye_world.cast<double>() + step).cast<float>();
  moved.clip_from_world = (view.clip_from_world.cast<double>() * back).cast<float>();
  return moved;
}

View view_of_moved(const View& view, const Pose& world_now_from_start) {
  auto direction = [&](const Eigen::Vector3f& d) -> Eigen::Vector3f {
    return world_now_from_start.inverse_direction(d.cast<double>()).cast<float>();
  };
  View moved = view;
  moved.clip_from_world =
      (view.clip_from_world.cast<double>() * matrix_of(world_now_from_start)).cast<float>();
  moved.eye_world = world_now_from_start.inverse_point(view.eye_world.cast<double>()).cast<float>();
  moved.right_world = direction(view.right_world);
  moved.up_world = direction(view.up_world);
  moved.back_world = direction(view.back_world);
  moved.shown_world = matrix_of(world_now_from_start).transpose().cast<float>() * view.shown_world;
  return moved;
}

bool may_be_in_frame(const View& view, const Eigen::AlignedBox3f& box_world) {
  constexpr float kRounding = 1.001f;
  bool left = true, right = true, below = true, above = true, behind = true;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector4f clip =
        view.clip_from_world *
        box_world.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)).homogeneous().eval();
    const float side = kRounding * clip.w();
    left = left && clip.x() < -side;
    right = right && clip.x() > side;
    below = below && clip.y() < -side;
    above = above && clip.y() > side;
    behind = behind && clip.w() < 0.0f;
  }
  return !(left || right || below || above || behind);
}

Eigen::Matrix4d matrix_of(const Pose& pose) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = pose.orientation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = pose.position;
  return matrix;
}

Eigen::AlignedBox3f moved_box(const Eigen::AlignedBox3f& box, const Pose& pose) {
  if (box.isEmpty()) return box;
  return box.cast<double>().transformed(Eigen::Isometry3d(matrix_of(pose))).cast<float>();
}

}  // namespace sulcus
