#include <epoxy/gl.h>

#include "engine/graphics/gl_scene.hpp"

namespace sulcus {

GeometryImage GlScene::draw_geometry(const FrameState& state) {
  undrawn_ = undrawn_.with(changed_pixels(state));
  const int width = frame_->width(), height = frame_->height();
  if (!geometry_ || geometry_->width() != width || geometry_->height() != height) {
    geometry_ = std::make_unique<GlGeometry>(width, height);
  }
  geometry_->begin();
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  GlProgram& solids = geometry_->solids();
  const std::vector<std::size_t> shown = bodies_in_sight(state);
  if (settings_.section) glEnable(GL_CLIP_DISTANCE0);
  for (const std::size_t i : shown) {
    solids.use();
    solids.set("object", ShownObject::surface(i).code());
    bodies_[i]->draw(solids, view_, i == 0 ? state.pieces : std::span<const Pose>{}, frame_->all(),
                     width, height);
  }
  glDisable(GL_CLIP_DISTANCE0);
  if (state.burr_shown) {
    solids.use();
    solids.set("shown", Eigen::Vector4f(Eigen::Vector4f::UnitW()));  // a section leaves it whole
    solids.set("clip_from_world", view_.clip_from_world);
    solids.set("right_world", view_.right_world);
    solids.set("up_world", view_.up_world);
    solids.set("back_world", view_.back_world);
    burr_.draw_parts(solids, state.world_from_tool, ShownObject{ShownObject::Kind::kBurr}.code(),
                     ShownObject{ShownObject::Kind::kHandpiece}.code(), shows_handpiece(state));
  }
  glDisable(GL_CULL_FACE);
  if (settings_.section) {
    if (!section_) section_.emplace();
    // Towards the half that was left out.
    const Eigen::Vector3f out = -view_.shown_world.head<3>();
    GlProgram& faces = geometry_->faces();
    faces.use();
    faces.set("normal_camera", Eigen::Vector3f(view_.right_world.dot(out), -view_.up_world.dot(out),
                                               -view_.back_world.dot(out)));
    for (const std::size_t i : shown) {
      faces.use();
      faces.set("object", ShownObject::section_face(i).code());
      const GlBody& body = *bodies_[i];
      section_->draw(section_face(body.surface(), body.world_from_grid(), *settings_.section),
                     view_, faces);
    }
  }
  glDisable(GL_DEPTH_TEST);
  return geometry_->read();
}

}  // namespace sulcus
