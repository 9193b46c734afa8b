#pragma once

#include <string>

#include <Eigen/Core>

#include "engine/graphics/gl_framebuffer.hpp"
#include "engine/graphics/window_input.hpp"

struct GLFWwindow;
struct ImGuiContext;

namespace sulcus {

/// A window with an OpenGL context that is current on its thread, and panels over the picture. One
/// at a time, on the main thread.
class Window {
 public:
  /// Throws std::runtime_error where there is no display or no OpenGL on it.
  Window(const std::string& title, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// False once it was closed, by whatever: also where it was destroyed or its display is lost.
  bool is_open() const;
  /// By the program.
  void close();
  /// Begins a frame: takes what has happened, and lets panels be drawn.
  WindowInput begin();
  /// Ends it: the picture, scaled to the window, and the panels over it. Waits for the display, and
  /// is not faster than 60 frames a second. `inset`: over the picture, its lower left corner at a
  /// pixel from the window's.
  void end(const GlFramebuffer& picture, const GlFramebuffer* inset = nullptr,
           const Eigen::Vector2i& inset_at = {0, 0});
  /// Pixels, as of the last `begin`.
  const Eigen::Vector2i& size() const { return size_; }
  /// Into the clipboard.
  void copy(const std::string& text);

 private:
  GLFWwindow* window_ = nullptr;
  ImGuiContext* context_ = nullptr;
  std::string keys_;
  Eigen::Vector2i size_{16, 16};
  double last_frame_s_ = 0.0;
};

}  // namespace sulcus
