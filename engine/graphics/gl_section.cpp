#include "engine/graphics/gl_section.hpp"

#include <epoxy/gl.h>

#include "engine/graphics/shaders.hpp"

namespace sulcus {

GlSection::GlSection() : program_("section", kSectionVertex, kSectionFragment) {
  glGenVertexArrays(1, &array_);
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

GlSection::~GlSection() {
  glDeleteVertexArrays(1, &array_);
  glDeleteTextures(1, &texture_);
}

void GlSection::draw(const SectionFace& face, const View& view, GlProgram& program) const {
  if (face.pixels.empty()) return;
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, face.width, face.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               face.pixels.data());
  program.use();
  program.set("clip_from_world", view.clip_from_world);
  program.set("corner", Eigen::Vector3f(face.corner_world.cast<float>()));
  program.set("along", Eigen::Vector3f(face.along_world.cast<float>()));
  program.set("across", Eigen::Vector3f(face.across_world.cast<float>()));
  program.set("tissues", 0);
  glBindVertexArray(array_);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace sulcus
