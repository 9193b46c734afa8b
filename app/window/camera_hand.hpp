#pragma once

#include <optional>

#include <Eigen/Core>

#include "engine/graphics/camera.hpp"

namespace sulcus {

/// A camera in the hand: turned round what it looks at, moved, and brought nearer to what is under
/// the pointer. Places and drags are in half heights of the picture (view_place.hpp).
class CameraHand {
 public:
  explicit CameraHand(const Viewpoint& start) { take(start); }

  /// All of it anew.
  void take(const Viewpoint& from);
  void turn(const Eigen::Vector2d& drag);
  /// So that a point of the world follows the pointer; none: what the camera looks at.
  /// `view`: as drawn, of the height in pixels.
  void move(const Eigen::Vector2d& drag, const View& view, int height,
            const std::optional<Eigen::Vector3d>& point_world);
  /// By so many notches of a wheel. What is seen at the pointer stays there, and the camera then
  /// looks more and more at `point_world`, the point of the solid there; none: at what is as deep
  /// as what it looked at.
  void zoom(double notches, const Eigen::Vector2d& pointer, const View& view, int height,
            const std::optional<Eigen::Vector3d>& point_world);
  Viewpoint from() const;
  /// As Viewpoint's.
  double azimuth_deg() const { return azimuth_deg_; }

 private:
  double azimuth_deg_ = 0.0, elevation_deg_ = 0.0;
  Viewpoint at_{Camera::kReview};  // but for its direction, which the angles say
};

}  // namespace sulcus
