#pragma once

#include "engine/graphics/camera.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/surface/colour_scale.hpp"

struct ImGuiContext;
struct ImFont;

namespace sulcus {

/// What of it is drawn.
struct HudParts {
  bool title = true;    // with the time and the scale bar
  bool figures = true;  // curves, contacts, what was removed, stages
  bool arrows = false;  // of force and torque, at the burr
  bool scales = true;   // of colours, where they stand for a quantity
  bool any() const { return title || figures || arrows || scales; }
};

/// The figures over the picture: title and time, curves of force, torque and tick time with their
/// values, contacts, removed volume, a scale bar and scales of colours. Keeps to the frame's left
/// and right edges, but for the arrows and the voxels in contact. On the thread of the OpenGL
/// context that was current when it was made, and while that lives.
class Hud {
 public:
  /// Letters are sized for frames of this height, pixels.
  explicit Hud(int frame_height);
  ~Hud();
  Hud(const Hud&) = delete;
  Hud& operator=(const Hud&) = delete;

  /// Draws into the bound framebuffer. `view`: for the scale bar and the arrows. `colours`: of the
  /// surface; null where it has those of tissues.
  void draw(const FrameState& state, int width, int height, const View& view, const HudParts& parts,
            const ColourScale* colours);

 private:
  ImGuiContext* context_ = nullptr;
  ImFont* text_ = nullptr;
  ImFont* title_ = nullptr;
  float scale_ = 1.0f;  // pixels per pixel of a frame 720 high
};

}  // namespace sulcus
