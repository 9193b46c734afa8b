#include "engine/graphics/gl_scene.hpp"

#include <stdexcept>
#include <utility>

#include <epoxy/gl.h>

#include "engine/graphics/shaders.hpp"
#include "engine/graphics/sight.hpp"

namespace sulcus {
namespace {

// Of the points to see, before a body is left out. Teeth that stand in a row hide a sixth of each
// other's crowns from the review camera, and all of them from mesial.
constexpr double kHiddenShare = 1.0 / 3.0;

std::vector<std::unique_ptr<GlBody>> gl_bodies(std::vector<RenderedBody> bodies) {
  if (bodies.empty()) throw std::invalid_argument("a renderer needs a workpiece");
  const Pose& workpiece = bodies.front().world_from_grid;
  if (!workpiece.position.isZero(0.0) ||
      !workpiece.orientation.coeffs().isApprox(Pose{}.orientation.coeffs(), 0.0)) {
    throw std::invalid_argument("the workpiece's grid is not where the world is");
  }
  std::vector<std::unique_ptr<GlBody>> made;
  made.reserve(bodies.size());
  for (RenderedBody& body : bodies) made.push_back(std::make_unique<GlBody>(std::move(body)));
  return made;
}

}  // namespace

GlScene::GlScene(const RenderSettings& settings, std::vector<RenderedBody> bodies,
                 const TriangleMesh& burr_mesh_tool, double burr_head_length_m)
    : settings_(settings),
      from_(settings.camera),
      bodies_(gl_bodies(std::move(bodies))),
      burr_(burr_mesh_tool, burr_head_length_m),
      background_program_("background", kBackgroundVertex, kBackgroundFragment),
      tooth_program_("tooth", kToothVertex, kToothFragment),
      smooth_program_("smooth", kBackgroundVertex, kSmoothFragment) {
  for (std::size_t i = 1; i < bodies_.size(); ++i) others_world_.push_back(bodies_[i]->box_world());
  set_size(settings.width, settings.height);
  glGenVertexArrays(1, &background_array_);
}

GlScene::~GlScene() { glDeleteVertexArrays(1, &background_array_); }

void GlScene::set_size(int width, int height) {
  if (frame_ && frame_->width() == width && frame_->height() == height) return;
  frame_ = std::make_unique<GlFramebuffer>(width, height);
  if (settings_.hud) hud_.emplace(height);
}

void GlScene::add_piece(std::span<const std::uint32_t> voxels) {
  bodies_.front()->add_piece(voxels);
}

void GlScene::draw(const FrameState& state) {
  GlBody& workpiece = *bodies_.front();
  workpiece.update(state.pieces);
  for (std::size_t i = 1; i < bodies_.size(); ++i) bodies_[i]->update({});
  const Eigen::Vector3d& tip_world = state.world_from_tool.position;
  view_ = make_view(from_, workpiece.solid_at_start(), tip_world, burr_.radius_m(), frame_->width(),
                    frame_->height(), others_world_);
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
  burr_.draw(view_, state.world_from_tool, state.burr_turn_rad);
  workpiece.draw(tooth_program_, view_, state.pieces);
  if (bodies_.size() > 1) {
    const std::vector<Eigen::Vector3d> points =
        points_to_see(from_, workpiece.solid_at_start(), tip_world);
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
      const GlBody& body = *bodies_[i];
      const double hidden = hidden_share(view_.eye_world.cast<double>(), points,
                                         body.solid_at_start(), body.world_from_grid());
      if (hidden < kHiddenShare) body.draw(tooth_program_, view_, {});
    }
  }
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  frame_->begin_overlay();
  smooth_program_.use();
  smooth_program_.set("picture", 0);
  glBindVertexArray(background_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  if (hud_) hud_->draw(state, frame_->width(), frame_->height(), view_.metres_per_pixel);
}

std::size_t GlScene::triangle_count() const {
  std::size_t count = 0;
  for (const auto& body : bodies_) count += body->triangle_count();
  return count;
}

std::size_t GlScene::memory_bytes() const {
  const std::size_t pixels = static_cast<std::size_t>(frame_->width()) * frame_->height();
  std::size_t bytes = burr_.bytes() + pixels * 12;
  for (const auto& body : bodies_) bytes += body->memory_bytes();
  return bytes;
}

}  // namespace sulcus
