#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

namespace sulcus {

/// What mouse and keyboard did since the last frame, but for what was meant for a panel.
struct WindowInput {
  Eigen::Vector2d drag = Eigen::Vector2d::Zero();  // right and up, in half heights of the window
  double wheel = 0.0;                              // notches, away from the user
  bool left = false, middle = false, right = false, shift = false, control = false;  // held
  // Pressed: letters and digits in lower case, ' ', '<' and '>' for the arrows, kEscape.
  std::string keys;
  // Right and up from the window's middle, in its half heights; none over a panel.
  std::optional<Eigen::Vector2d> pointer;
  bool pressed = false;  // a button that was not held before

  static constexpr char kEscape = '\x1b';
};

}  // namespace sulcus
