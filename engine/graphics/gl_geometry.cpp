#include "engine/graphics/gl_geometry.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include <epoxy/gl.h>

#include "engine/graphics/geometry_shaders.hpp"

namespace sulcus {

GlGeometry::GlGeometry(int width, int height)
    : width_(width),
      height_(height),
      solids_("geometry", kGeometryVertex, kGeometryFragment),
      faces_("geometry of a section", kFaceGeometryVertex, kFaceGeometryFragment) {
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  const auto attach = [&](unsigned& buffer, GLenum format, GLenum where) {
    glGenRenderbuffers(1, &buffer);
    glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    glRenderbufferStorage(GL_RENDERBUFFER, format, width_, height_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, where, GL_RENDERBUFFER, buffer);
  };
  attach(numbers_, GL_RGBA32F, GL_COLOR_ATTACHMENT0);
  attach(objects_, GL_R32UI, GL_COLOR_ATTACHMENT1);
  attach(depth_, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("OpenGL here cannot draw numbers off the screen");
  }
}

GlGeometry::~GlGeometry() {
  glDeleteFramebuffers(1, &framebuffer_);
  for (const unsigned* buffer : {&numbers_, &objects_, &depth_}) glDeleteRenderbuffers(1, buffer);
}

void GlGeometry::begin() {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  constexpr std::array<GLenum, 2> kBoth{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(2, kBoth.data());
  glViewport(0, 0, width_, height_);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
  constexpr std::array<GLfloat, 4> kZero{};
  constexpr std::array<GLuint, 4> kNothing{};
  constexpr GLfloat kFarthest = 1.0f;
  glClearBufferfv(GL_COLOR, 0, kZero.data());
  glClearBufferuiv(GL_COLOR, 1, kNothing.data());
  glClearBufferfv(GL_DEPTH, 0, &kFarthest);
  solids_.use();
  solids_.set("world_from_model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
}

GeometryImage GlGeometry::read() const {
  const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  std::vector<std::array<float, 4>> numbers(width * height);
  std::vector<std::uint32_t> objects(width * height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_FLOAT, numbers.data());
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, width_, height_, GL_RED_INTEGER, GL_UNSIGNED_INT, objects.data());
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  GeometryImage image{width_, height_, {}, {}, {}};
  image.depth_m.resize(width * height);
  image.normal_camera.resize(width * height);
  image.objects.resize(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t from = (height - 1 - y) * width, to = y * width;
    for (std::size_t x = 0; x < width; ++x) {
      const std::array<float, 4>& number = numbers[from + x];
      image.normal_camera[to + x] = {number[0], number[1], number[2]};
      image.depth_m[to + x] = number[3];
    }
    std::copy_n(&objects[from], width, &image.objects[to]);
  }
  return image;
}

}  // namespace sulcus
