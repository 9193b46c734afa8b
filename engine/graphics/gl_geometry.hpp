#pragma once

#include "engine/graphics/geometry_image.hpp"
#include "engine/graphics/gl_program.hpp"

namespace sulcus {

/// Where a GeometryImage is drawn: a framebuffer of numbers instead of colours, and the programs
/// that fill it. Made, used and destroyed with the same OpenGL context current.
class GlGeometry {
 public:
  /// Throws std::runtime_error where the context cannot make one of this size.
  GlGeometry(int width, int height);
  ~GlGeometry();
  GlGeometry(const GlGeometry&) = delete;
  GlGeometry& operator=(const GlGeometry&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  /// Binds it for drawing, with nothing in it.
  void begin();
  /// Of bodies, pieces and the burr; what it draws is "object".
  GlProgram& solids() { return solids_; }
  /// Of faces of sections.
  GlProgram& faces() { return faces_; }
  GeometryImage read() const;

 private:
  int width_, height_;
  GlProgram solids_, faces_;
  // Normal and depth; object; depth as OpenGL compares it.
  unsigned framebuffer_ = 0, numbers_ = 0, objects_ = 0, depth_ = 0;
};

}  // namespace sulcus
