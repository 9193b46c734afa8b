// The mouth mirror of a scene: the same meshes from a second camera, into a picture of its own.

#include <epoxy/gl.h>

#include "engine/graphics/gl_scene.hpp"
#include "engine/graphics/mirror.hpp"

namespace sulcus {

const GlFramebuffer& GlScene::draw_mirror(const Viewpoint& from, const FrameState& state, int width,
                                          int height) {
  if (!mirror_ || mirror_->width() != width || mirror_->height() != height) {
    mirror_ = std::make_unique<GlFramebuffer>(width, height);
  }
  const GlBody& workpiece = *bodies_.front();
  View view = mirrored(make_view(from, workpiece.solid_at_start(), state.world_from_tool.position,
                                 burr_.radius_m(), width, height, others_world_));
  const PixelRect all = mirror_->all();
  mirror_->begin_bodies(all);
  draw_background();
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);
  for (const auto& body : bodies_) {
    body->draw(tooth_program_, view,
               body.get() == &workpiece ? state.pieces : std::span<const Pose>{}, all, width,
               height);
  }
  if (state.burr_shown) burr_.draw(view, state.world_from_tool, state.burr_turn_rad, false);
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  mirror_->begin_scene(all, {});
  mirror_->skip_smooth(all);
  mirror_->begin_picture();
  return *mirror_;
}

}  // namespace sulcus
