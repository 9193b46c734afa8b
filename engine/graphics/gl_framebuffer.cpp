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
  glGenTextures(1, &scene_texture_);
  glBindTexture(GL_TEXTURE_2D, scene_texture_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  make(bodies_, Depth::kOwn);
  make(scene_, Depth::kOwn);
  make(smooth_, Depth::kNone);
  make(picture_, Depth::kNone);
}

GlFramebuffer::~GlFramebuffer() {
  for (Layer* layer : {&bodies_, &scene_, &smooth_, &picture_}) {
    glDeleteFramebuffers(1, &layer->framebuffer);
    glDeleteRenderbuffers(1, &layer->colour);
    glDeleteRenderbuffers(1, &layer->depth);
  }
  glDeleteTextures(1, &scene_texture_);
}

void GlFramebuffer::make(Layer& layer, Depth depth) {
  glGenFramebuffers(1, &layer.framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, layer.framebuffer);
  if (&layer == &scene_) {
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, scene_texture_, 0);
  } else {
    glGenRenderbuffers(1, &layer.colour);
    glBindRenderbuffer(GL_RENDERBUFFER, layer.colour);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width_, height_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, layer.colour);
  }
  if (depth == Depth::kOwn) {
    glGenRenderbuffers(1, &layer.depth);
    glBindRenderbuffer(GL_RENDERBUFFER, layer.depth);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width_, height_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, layer.depth);
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("OpenGL here cannot draw off the screen");
  }
}

void GlFramebuffer::bind(const Layer& layer, const PixelRect& pixels) const {
  glBindFramebuffer(GL_FRAMEBUFFER, layer.framebuffer);
  glViewport(0, 0, width_, height_);
  glEnable(GL_SCISSOR_TEST);
  glScissor(pixels.x, pixels.y, pixels.width, pixels.height);
}

void GlFramebuffer::copy(const Layer& from, const PixelRect& pixels, unsigned what) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, from.framebuffer);
  const int right = pixels.x + pixels.width, top = pixels.y + pixels.height;
  glBlitFramebuffer(pixels.x, pixels.y, right, top, pixels.x, pixels.y, right, top, what,
                    GL_NEAREST);
}

void GlFramebuffer::begin_bodies(const PixelRect& pixels) const { bind(bodies_, pixels); }

void GlFramebuffer::begin_scene(const PixelRect& pixels, const PixelRect& depth) const {
  bind(scene_, pixels);
  copy(bodies_, pixels, GL_COLOR_BUFFER_BIT);
  if (!depth.empty()) copy(bodies_, depth, GL_DEPTH_BUFFER_BIT);
}

void GlFramebuffer::skip_smooth(const PixelRect& pixels) const {
  bind(smooth_, pixels);
  copy(scene_, pixels, GL_COLOR_BUFFER_BIT);
}

void GlFramebuffer::begin_smooth(const PixelRect& pixels) const {
  bind(smooth_, pixels);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, scene_texture_);
}

void GlFramebuffer::begin_picture() const {
  bind(picture_, all());
  copy(smooth_, all(), GL_COLOR_BUFFER_BIT);
}

void GlFramebuffer::show(int width, int height) const {
  glDisable(GL_SCISSOR_TEST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, picture_.framebuffer);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  const bool same = width == width_ && height == height_;
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width, height, GL_COLOR_BUFFER_BIT,
                    same ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
}

void GlFramebuffer::show_at(int x, int y) const {
  glDisable(GL_SCISSOR_TEST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, picture_.framebuffer);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, width_, height_, x, y, x + width_, y + height_, GL_COLOR_BUFFER_BIT,
                    GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void GlFramebuffer::finish() const { glFinish(); }

Image GlFramebuffer::read() const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, picture_.framebuffer);
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
