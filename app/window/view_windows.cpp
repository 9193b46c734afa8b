#include "app/window/view_windows.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/units.hpp"

namespace sulcus {

ViewCamera::ViewCamera(Camera start) : at_(start) { take(start); }

void ViewCamera::take(Camera named) {
  at_ = Viewpoint(named);
  const Eigen::Vector3d& back = at_.back_world;
  elevation_deg_ = std::asin(std::clamp(back.z(), -1.0, 1.0)) / kDegree;
  // Straight from above the azimuth is that of what is down in the picture.
  const Eigen::Vector3d& level = std::abs(back.z()) > 0.999 ? -at_.upright_world : back;
  azimuth_deg_ = std::atan2(level.y(), level.x()) / kDegree;
}

void ViewCamera::turn(const WindowInput& input) {
  constexpr double kTurn_deg = 90.0;  // for half a height of the window
  azimuth_deg_ -= kTurn_deg * input.drag.x();
  elevation_deg_ = std::clamp(elevation_deg_ - kTurn_deg * input.drag.y(), -90.0, 90.0);
}

void ViewCamera::move(const WindowInput& input) { at_.pan -= input.drag; }

void ViewCamera::follow(const WindowInput& input) {
  at_.zoom = std::clamp(at_.zoom * std::pow(1.15, input.wheel), 0.3, 30.0);
  for (const char key : input.keys) {
    if (key >= '1' && key <= '5') take(static_cast<Camera>(key - '1'));
  }
}

Viewpoint ViewCamera::from() const {
  Viewpoint from(azimuth_deg_, elevation_deg_);
  from.follows_burr = at_.follows_burr;
  from.zoom = at_.zoom;
  from.pan = at_.pan;
  return from;
}

void set_picture(GlScene& drawing, const ViewCamera& camera, const PictureControls& controls,
                 const Window& window, bool moves) {
  drawing.set_detail(moves ? Detail::kCoarse : Detail::kFull);
  drawing.set_viewpoint(camera.from());
  drawing.set_section(controls.section());
  drawing.set_handpiece(false);
  drawing.set_hud({.title = true, .figures = controls.figures, .arrows = controls.arrows});
  drawing.set_size(window.size().x(), window.size().y());
}

}  // namespace sulcus
