#include "app/window/camera_hand.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/units.hpp"
#include "engine/graphics/view_place.hpp"

namespace sulcus {

namespace {

constexpr double kNotch = 1.15;  // how much nearer
constexpr double kNearest_m = 1.5 * kMillimetre, kFarthest_m = 500.0 * kMillimetre;
constexpr double kLeastZoom = 0.3, kMostZoom = 10.0;  // of what follows the burr

}  // namespace

void CameraHand::take(const Viewpoint& from) {
  at_ = from;
  const Eigen::Vector3d& back = at_.back_world;
  elevation_deg_ = std::asin(std::clamp(back.z(), -1.0, 1.0)) / kDegree;
  // Straight from above the azimuth is that of what is down in the picture.
  const Eigen::Vector3d level =
      std::abs(back.z()) > 0.999 ? Eigen::Vector3d(-at_.upright_world) : back;
  azimuth_deg_ = std::atan2(level.y(), level.x()) / kDegree;
}

void CameraHand::turn(const Eigen::Vector2d& drag) {
  constexpr double kTurn_deg = 90.0;  // for half a height of the window
  azimuth_deg_ -= kTurn_deg * drag.x();
  elevation_deg_ = std::clamp(elevation_deg_ - kTurn_deg * drag.y(), -90.0, 90.0);
}

void CameraHand::move(const Eigen::Vector2d& drag, const View& view, int height,
                      const std::optional<Eigen::Vector3d>& point_world) {
  if (at_.follows_burr) {
    at_.pan -= drag;
    return;
  }
  if (!at_.look_at) at_.look_at = look_at_of(view, height);
  const double depth =
      point_world ? depth_of(view, *point_world) : look_at_of(view, height).distance_m;
  at_.look_at->point_world -=
      slope_of(view) * depth *
      (drag.x() * view.right_world.cast<double>() + drag.y() * view.up_world.cast<double>());
}

void CameraHand::zoom(double notches, const Eigen::Vector2d& pointer, const View& view, int height,
                      const std::optional<Eigen::Vector3d>& point_world) {
  if (notches == 0.0) return;
  const double wanted = std::pow(kNotch, notches);
  if (at_.follows_burr) {
    const double before = at_.zoom;
    at_.zoom = std::clamp(before * wanted, kLeastZoom, kMostZoom);
    const double nearer = at_.zoom / before;
    // The eye goes along the line of sight through the pointer.
    at_.pan = nearer * at_.pan + (nearer - 1.0) * pointer;
    return;
  }
  const LookAt before = at_.look_at.value_or(look_at_of(view, height));
  const double distance = std::clamp(before.distance_m / wanted, kNearest_m, kFarthest_m);
  Eigen::Vector3d towards = before.point_world;
  if (point_world) {
    towards = *point_world;
  } else {
    towards += slope_of(view) * before.distance_m *
               (pointer.x() * view.right_world.cast<double>() +
                pointer.y() * view.up_world.cast<double>());
  }
  // Eye and what it looks at come nearer to the point by one factor: its direction stays.
  const double left = distance / before.distance_m;
  at_.look_at = LookAt{towards + left * (before.point_world - towards), distance};
}

Viewpoint CameraHand::from() const {
  Viewpoint from(azimuth_deg_, elevation_deg_);
  from.follows_burr = at_.follows_burr;
  from.zoom = at_.zoom;
  from.pan = at_.pan;
  from.look_at = at_.look_at;
  return from;
}

}  // namespace sulcus
