#pragma once

#include "engine/graphics/frame_state.hpp"

struct ImGuiContext;
struct ImFont;

namespace sulcus {

/// The figures over the picture: title and time, curves of force, torque and tick time with their
/// values, contacts, removed volume, and a scale bar. Keeps to the frame's left and right edges. On
/// the thread of the OpenGL context that was current when it was made, and while that lives.
class Hud {
 public:
  /// Letters are sized for frames of this height, pixels.
  explicit Hud(int frame_height);
  ~Hud();
  Hud(const Hud&) = delete;
  Hud& operator=(const Hud&) = delete;

  /// Draws into the bound framebuffer. `metres_per_pixel`: for the scale bar.
  void draw(const FrameState& state, int width, int height, double metres_per_pixel);

 private:
  ImGuiContext* context_ = nullptr;
  ImFont* text_ = nullptr;
  ImFont* title_ = nullptr;
  float scale_ = 1.0f;  // pixels per pixel of a frame 720 high
};

}  // namespace sulcus
