#include "engine/graphics/gl_ghost.hpp"

#include <utility>

#include <epoxy/gl.h>

#include "engine/graphics/shaders.hpp"
#include "engine/surface/section_face.hpp"

namespace sulcus {

GlGhost::GlGhost(VoxelModel shape)
    : surface_(std::move(shape), {{"ghost", {1.0f, 1.0f, 1.0f}}}),
      bricks_(static_cast<std::size_t>(surface_.brick_count())),
      walls_("ghost", kGhostVertex, kGhostFragment),
      face_("ghost in a section", kSectionVertex, kGhostSectionFragment) {
  DrawnSurface::Scratch scratch;
  DrawnMesh mesh;
  for (const int brick : surface_.take_changed()) {
    surface_.mesh(brick, scratch, mesh);
    bricks_[static_cast<std::size_t>(brick)].upload(mesh);
  }
}

void GlGhost::draw(const View& view, const std::optional<Section>& section) {
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  walls_.use();
  walls_.set("clip_from_world", view.clip_from_world);
  walls_.set("eye_world", view.eye_world);
  walls_.set("shown", view.shown_world);
  if (section) glEnable(GL_CLIP_DISTANCE0);
  for (const GlMesh& brick : bricks_) brick.draw();
  glDisable(GL_CLIP_DISTANCE0);
  glDisable(GL_CULL_FACE);
  if (section) section_.draw(section_face(surface_, {}, *section), view, face_);
  glDisable(GL_BLEND);
}

}  // namespace sulcus
