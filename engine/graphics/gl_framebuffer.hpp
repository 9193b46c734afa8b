#pragma once

#include "engine/graphics/image.hpp"
#include "engine/graphics/pixel_rect.hpp"

namespace sulcus {

/// What is drawn into instead of a window, in layers, so that of a picture like the one before it
/// only what is different is drawn again:
///
///   bodies --copied--> scene (with the burr) --smoothed--> smooth --copied--> picture (with
///   figures)
///
/// Each is drawn into within a rectangle; outside of it stays what was there.
class GlFramebuffer {
 public:
  /// Throws std::runtime_error where the context cannot make one of this size.
  GlFramebuffer(int width, int height);
  ~GlFramebuffer();
  GlFramebuffer(const GlFramebuffer&) = delete;
  GlFramebuffer& operator=(const GlFramebuffer&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  PixelRect all() const { return {0, 0, width_, height_}; }
  /// Each binds its layer for drawing within `pixels`; those that follow on another take over from
  /// that what is there.
  void begin_bodies(const PixelRect& pixels) const;
  /// `depth`: where depths are taken over as well, for what is drawn in there.
  void begin_scene(const PixelRect& pixels, const PixelRect& depth) const;
  /// The scene's colours are the texture of unit 0.
  void begin_smooth(const PixelRect& pixels) const;
  /// In place of smoothing: takes the scene over as it is.
  void skip_smooth(const PixelRect& pixels) const;
  void begin_picture() const;
  /// Copies the picture, scaled, into the framebuffer of a window, and binds that.
  void show(int width, int height) const;
  /// The same unscaled, with its lower left corner at a pixel from the window's.
  void show_at(int x, int y) const;
  Image read() const;
  /// Waits until all that was drawn is there.
  void finish() const;

 private:
  struct Layer {
    unsigned framebuffer = 0, colour = 0, depth = 0;  // colour and depth are renderbuffers
  };
  enum class Depth { kNone, kOwn };
  void make(Layer& layer, Depth depth);
  void bind(const Layer& layer, const PixelRect& pixels) const;
  void copy(const Layer& from, const PixelRect& pixels, unsigned what) const;

  int width_, height_;
  Layer bodies_, scene_, smooth_, picture_;
  unsigned scene_texture_ = 0;  // the scene's colour
};

}  // namespace sulcus
