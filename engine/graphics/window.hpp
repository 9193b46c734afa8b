#pragma once

#include <string>

#include <Eigen/Core>

#include "engine/graphics/gl_framebuffer.hpp"

struct GLFWwindow;
struct ImGuiContext;

namespace sulcus {

/// What mouse and keyboard did since the last frame, but for what was meant for a panel.
struct WindowInput {
  Eigen::Vector2d drag = Eigen::Vector2d::Zero();  // right and up, in half heights of the window
  double wheel = 0.0;                              // notches, away from the user
  bool left = false, middle = false, right = false, shift = false, control = false;  // held
  std::string keys;  // pressed: letters and digits in lower case, ' ', '<' and '>' for the arrows
};

/// A window with an OpenGL context that is current on its thread, and panels over the picture. One
/// at a time, on the main thread.
class Window {
 public:
  /// Throws std::runtime_error where there is no display or no OpenGL on it.
  Window(const std::string& title, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  bool is_open() const;
  /// Begins a frame: takes what has happened, and lets panels be drawn.
  WindowInput begin();
  /// Ends it: the picture, scaled to the window, and the panels over it. Waits for the display, and
  /// is not faster than 60 frames a second.
  void end(const GlFramebuffer& picture);
  /// Pixels.
  Eigen::Vector2i size() const;

 private:
  GLFWwindow* window_ = nullptr;
  ImGuiContext* context_ = nullptr;
  std::string keys_;
  double last_frame_s_ = 0.0;
};

}  // namespace sulcus
