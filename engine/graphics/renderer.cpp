#include "engine/graphics/renderer.hpp"

#include <utility>

#include <epoxy/gl.h>

#include "engine/graphics/camera.hpp"
#include "engine/graphics/shaders.hpp"

namespace sulcus {

Renderer::Renderer(const RenderSettings& settings, VoxelModel model, std::vector<TissueLook> looks,
                   const TriangleMesh& burr_mesh_tool, double burr_head_length_m)
    : settings_(settings),
      camera_(settings.camera),
      workpiece_(std::move(model), std::move(looks)),
      solid_world_(solid_slabs(workpiece_.surface().model())),
      burr_(burr_mesh_tool, burr_head_length_m),
      background_program_("background", kBackgroundVertex, kBackgroundFragment),
      tooth_program_("tooth", kToothVertex, kToothFragment),
      smooth_program_("smooth", kBackgroundVertex, kSmoothFragment) {
  set_size(settings.width, settings.height);
  glGenVertexArrays(1, &background_array_);
}

Renderer::~Renderer() {
  context_.make_current();
  glDeleteVertexArrays(1, &background_array_);
}

void Renderer::set_size(int width, int height) {
  context_.make_current();
  if (frame_ && frame_->width() == width && frame_->height() == height) return;
  frame_ = std::make_unique<GlFramebuffer>(width, height);
  if (settings_.hud) hud_.emplace(height);
}

void Renderer::add_piece(std::span<const std::uint32_t> voxels) {
  context_.make_current();
  workpiece_.add_piece(voxels);
}

Image Renderer::draw(const FrameState& state) {
  context_.make_current();
  workpiece_.update(state.pieces);
  const View view = make_view(camera_, solid_world_, state.world_from_tool.position,
                              burr_.radius_m(), frame_->width(), frame_->height());
  frame_->begin();
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  glClear(GL_DEPTH_BUFFER_BIT);
  background_program_.use();
  glBindVertexArray(background_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  burr_.draw(view, state.world_from_tool, state.burr_turn_rad);
  workpiece_.draw(tooth_program_, view, state.pieces);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  frame_->begin_overlay();
  smooth_program_.use();
  smooth_program_.set("picture", 0);
  glBindVertexArray(background_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  if (hud_) hud_->draw(state, frame_->width(), frame_->height(), view.metres_per_pixel);
  return frame_->read();
}

std::size_t Renderer::triangle_count() const { return workpiece_.triangle_count(); }

std::size_t Renderer::memory_bytes() const {
  const std::size_t pixels = static_cast<std::size_t>(frame_->width()) * frame_->height();
  return workpiece_.memory_bytes() + burr_.bytes() + pixels * 12;
}

}  // namespace sulcus
