#pragma once

#include "engine/graphics/camera.hpp"
#include "engine/graphics/gl_program.hpp"
#include "engine/surface/section_face.hpp"

namespace sulcus {

/// The faces of a section as OpenGL draws them. Made, used and destroyed with the same OpenGL
/// context current.
class GlSection {
 public:
  GlSection();
  ~GlSection();
  GlSection(const GlSection&) = delete;
  GlSection& operator=(const GlSection&) = delete;

  void draw(const SectionFace& face, const View& view) { draw(face, view, program_); }
  /// By another program of kSectionVertex, or one that takes what that does.
  void draw(const SectionFace& face, const View& view, GlProgram& program) const;

 private:
  GlProgram program_;
  unsigned array_ = 0, texture_ = 0;
};

}  // namespace sulcus
