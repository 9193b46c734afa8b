#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// What a camera sees: everything the shaders and the scale bar need of it.
struct View {
  Eigen::Matrix4f clip_from_world = Eigen::Matrix4f::Identity();  // OpenGL: x, y, z within -w to w
  Eigen::Vector3f eye_world = Eigen::Vector3f::Zero();            // m
  // Unit, right-handed; it looks along -back.
  Eigen::Vector3f right_world = Eigen::Vector3f::UnitX(), up_world = Eigen::Vector3f::UnitY(),
                  back_world = Eigen::Vector3f::UnitZ();
  double metres_per_pixel = 0.0;     // at the depth of the point that it looks at
  double focal_pixels = 0.0;         // of the pinhole: a metre at a depth of a metre is so many
  double near_m = 0.0, far_m = 0.0;  // depths that are drawn, from the eye along -back
  // Of the bodies that which is at (x, y, z) where its product with (x, y, z, 1) is not negative.
  Eigen::Vector4f shown_world = Eigen::Vector4f::UnitW();
};

/// A point that a camera looks at, and from how far.
struct LookAt {
  Eigen::Vector3d point_world;
  double distance_m;  // of the eye
};

/// Where a picture is taken from.
struct Viewpoint {
  Viewpoint(Camera named);  // NOLINT(google-explicit-constructor): a named one is one
  /// Degrees: from +x, which is mesial, towards +y, lingual; and up towards +z, -90 to 90.
  Viewpoint(double azimuth_deg, double elevation_deg);

  Eigen::Vector3d back_world;                     // unit, from what it looks at towards the eye
  Eigen::Vector3d upright_world;                  // what is up in the picture, not along back
  bool follows_burr = false;                      // else it frames what is solid
  double zoom = 1.0;                              // 2: twice as near
  Eigen::Vector2d pan = Eigen::Vector2d::Zero();  // to the right and up, in half heights of a frame
  std::optional<Eigen::Vector3d> middle_world = {};  // of the frame, else of what it frames
  // In place of a frame, of the burr or of what is solid, with its zoom and pan.
  std::optional<LookAt> look_at = {};
};

/// The view from there. `solid_world`: boxes that hold all that is solid at the start, which it
/// frames whole; none are taken as a box of 1 cm round the origin. One that follows the burr does
/// so by its tip, at a scale set by the burr's radius (m). `others_world`: boxes of what else is
/// drawn; they do not change what the frame takes in, but none of them is cut off for being far
/// away, nor for being near beyond 0.5 mm from the eye.
View make_view(const Viewpoint& from, std::span<const Eigen::AlignedBox3d> solid_world,
               const Eigen::Vector3d& tip_world, double burr_radius_m, int width, int height,
               std::span<const Eigen::AlignedBox3d> others_world = {});

/// The view of a camera so far to the right of it that looks the same way: the other one of a pair
/// with parallel axes. `by_m`: m, below 0 to the left.
View moved_right(const View& view, double by_m);

/// The view of a body that has moved, as if it had stayed and camera and lights had moved instead:
/// what is drawn where the body was shows where it is now. `world_now_from_start`: its motion.
View view_of_moved(const View& view, const Pose& world_now_from_start);

/// Whether anything inside a box may show: false only where the whole box lies beyond one side of
/// the frame, or behind the eye. `box_world`: not empty.
bool may_be_in_frame(const View& view, const Eigen::AlignedBox3f& box_world);

/// A pose as a matrix for points (x, y, z, 1).
Eigen::Matrix4d matrix_of(const Pose& pose);

/// A box that holds what is in `box` once it has moved; of an empty one an empty one.
Eigen::AlignedBox3f moved_box(const Eigen::AlignedBox3f& box, const Pose& pose);

}  // namespace sulcus
