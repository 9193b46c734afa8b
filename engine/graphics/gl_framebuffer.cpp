#include "engine/graphics/gl_framebuffer.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

#include <epoxy/gl.h>

namespace sulcus {

GlFramebuffer::GlFramebuffer(int width, int height) : width_(width), height_(height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  if (width < 1 || height < 1 || width > largest || height > largest) {
    throw std::runtime_error("a picture of " + std::to_string(width) + " x " +
                             std::to_string(height) + " pixels: OpenGL here draws 1 to " +
                             std::to_string(largest));
  }
  glGenFramebuffers(1, &scene_);
  glGenFramebuffers(1, &overlay_);
  glGenTextures(1, &colour_);
  glGenRenderbuffers(1, &depth_);
  glGenRenderbuffers(1, &overlay_colour_);
  glBindTexture(GL_TEXTURE_2D, colour_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, overlay_colour_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, scene_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour_, 0);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  glBindFramebuffer(GL_FRAMEBUFFER, overlay_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, overlay_colour_);
  complete = complete && glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  if (!complete) throw std::runtime_error("OpenGL here cannot draw off the screen");
}

GlFramebuffer::~GlFramebuffer() {
  glDeleteFramebuffers(1, &scene_);
  glDeleteFramebuffers(1, &overlay_);
  glDeleteTextures(1, &colour_);
  glDeleteRenderbuffers(1, &depth_);
  glDeleteRenderbuffers(1, &overlay_colour_);
}

void GlFramebuffer::begin() const {
  glBindFramebuffer(GL_FRAMEBUFFER, scene_);
  glViewport(0, 0, width_, height_);
}

void GlFramebuffer::begin_overlay() const {
  glBindFramebuffer(GL_FRAMEBUFFER, overlay_);
  glViewport(0, 0, width_, height_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, colour_);
}

void GlFramebuffer::show(int width, int height) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, overlay_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  const bool same = width == width_ && height == height_;
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width, height, GL_COLOR_BUFFER_BIT,
                    same ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
}

Image GlFramebuffer::read() const {
  const auto pixels = static_cast<std::size_t>(width_) * height_;
  std::vector<std::uint8_t> rgba(4 * pixels);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  Image image{width_, height_, std::vector<std::uint8_t>(3 * pixels)};
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* from = &rgba[4 * static_cast<std::size_t>(width_) * (height_ - 1 - y)];
    std::uint8_t* to = &image.rgb[3 * static_cast<std::size_t>(width_) * y];
    for (int x = 0; x < width_; ++x, from += 4, to += 3) std::copy(from, from + 3, to);
  }
  return image;
}

}  // namespace sulcus
