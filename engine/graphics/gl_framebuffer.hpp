#pragma once

#include "engine/graphics/image.hpp"

namespace sulcus {

/// What is drawn into instead of a window: colour and depth for the scene, and a second picture
/// into which the first is copied, smoothed, and the figures are drawn.
class GlFramebuffer {
 public:
  /// Throws std::runtime_error where the context cannot make one of this size.
  GlFramebuffer(int width, int height);
  ~GlFramebuffer();
  GlFramebuffer(const GlFramebuffer&) = delete;
  GlFramebuffer& operator=(const GlFramebuffer&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  /// Binds the scene's buffers.
  void begin() const;
  /// Binds the second picture, and the scene's colours as the texture of unit 0.
  void begin_overlay() const;
  /// Copies the second picture, scaled, into the framebuffer of a window, and binds that.
  void show(int width, int height) const;
  /// The second picture, which is bound.
  Image read() const;

 private:
  int width_, height_;
  unsigned scene_ = 0, overlay_ = 0;         // framebuffers
  unsigned colour_ = 0;                      // texture
  unsigned depth_ = 0, overlay_colour_ = 0;  // renderbuffers
};

}  // namespace sulcus
