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
// Cosine of the angle to the burr's axis below which the handpiece would hide what is cut.
constexpr double kDownOnIt = 0.82;  // 35 degrees
constexpr float kGhost = 0.35f;     // how much of the device's burr shows over what it is in

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
      hud_parts_{settings.hud, settings.hud, settings.arrows, settings.hud},
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
  drawn_ = false;
  if (hud_) hud_.emplace(height);
}

void GlScene::add_piece(std::span<const std::uint32_t> voxels) {
  bodies_.front()->add_piece(voxels);
}

std::vector<std::size_t> GlScene::bodies_in_sight(const FrameState& state) const {
  std::vector<std::size_t> shown{0};
  if (bodies_.size() == 1) return shown;
  const std::vector<Eigen::Vector3d> points =
      points_to_see(from_, bodies_.front()->solid_at_start(), state.world_from_tool.position);
  const Eigen::Vector3d eye_world =
      view_.eye_world.cast<double>() - eye_offset_m_ * view_.right_world.cast<double>();
  for (std::size_t i = 1; i < bodies_.size(); ++i) {
    const double hidden = hidden_share(eye_world, points, bodies_[i]->solid_at_start(),
                                       bodies_[i]->world_from_grid());
    if (hidden < kHiddenShare) shown.push_back(i);
  }
  return shown;
}

/// Those that would be in the way are left out, and of all what lies before a section.
void GlScene::draw_bodies(const FrameState& state, const PixelRect& pixels) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  const std::vector<std::size_t> shown = bodies_in_sight(state);
  shown_.clear();
  for (const std::size_t i : shown) shown_.push_back(bodies_[i].get());
  if (settings_.section) glEnable(GL_CLIP_DISTANCE0);
  for (const std::size_t i : shown) {
    bodies_[i]->draw(tooth_program_, view_, i == 0 ? state.pieces : std::span<const Pose>{}, pixels,
                     frame_->width(), frame_->height());
  }
  glDisable(GL_CULL_FACE);
  glDisable(GL_CLIP_DISTANCE0);
  if (settings_.section) {
    if (!section_) section_.emplace();
    for (const std::size_t i : shown) {
      const GlBody& body = *bodies_[i];
      section_->draw(section_face(body.surface(), body.world_from_grid(), *settings_.section),
                     view_);
    }
  }
  glDisable(GL_DEPTH_TEST);
}

PixelRect GlScene::changed_pixels(const FrameState& state) {
  GlBody& workpiece = *bodies_.front();
  Eigen::AlignedBox3f changed = workpiece.update(state.pieces, hurried_, detail_);
  for (std::size_t i = 1; i < bodies_.size(); ++i) {
    changed.extend(bodies_[i]->update({}, hurried_, detail_));
  }
  const View before = view_;
  view_ = make_view(from_, workpiece.solid_at_start(), state.world_from_tool.position,
                    burr_.radius_m(), frame_->width(), frame_->height(), others_world_);
  if (eye_offset_m_ != 0.0) view_ = moved_right(view_, eye_offset_m_);
  if (settings_.section) {
    const Section& section = *settings_.section;
    const float side = from_.back_world[section.axis] < 0.0 ? 1.0f : -1.0f;
    view_.shown_world = Eigen::Vector4f::Zero();
    view_.shown_world[section.axis] = side;
    view_.shown_world.w() = -side * static_cast<float>(section.at_m);
  }
  const bool same = drawn_ && detail_drawn_ == detail_ &&
                    before.clip_from_world == view_.clip_from_world && !settings_.section &&
                    !workpiece.has_pieces();
  drawn_ = !settings_.section;
  detail_drawn_ = detail_;
  return same ? pixels_of(view_, changed, frame_->width(), frame_->height()) : frame_->all();
}

bool GlScene::shows_handpiece(const FrameState& state) const {
  const Eigen::Vector3d axis_world = state.world_from_tool.direction(Eigen::Vector3d::UnitY());
  return handpiece_ && !from_.follows_burr && axis_world.dot(from_.back_world) < kDownOnIt;
}

PixelRect GlScene::burr_pixels(const FrameState& state) const {
  const auto pixels = [&](const Pose& pose, bool with_handpiece) {
    return pixels_of(view_, burr_.box_world(pose, with_handpiece), frame_->width(),
                     frame_->height());
  };
  PixelRect rect;
  if (state.burr_shown) rect = pixels(state.world_from_tool, shows_handpiece(state));
  if (state.device) rect = rect.with(pixels(*state.device, false));
  return rect;
}

void GlScene::draw(const FrameState& state) {
  const PixelRect bodies = undrawn_.with(changed_pixels(state));
  undrawn_ = {};
  if (!bodies.empty()) {
    frame_->begin_bodies(bodies);
    draw_background();
    draw_bodies(state, bodies);
  }
  // Where the burr is now, and where it was.
  const PixelRect burr = burr_pixels(state);
  const int width = frame_->width(), height = frame_->height();
  const PixelRect scene = bodies.with(burr).with(burr_before_).grown(0, width, height);
  burr_before_ = burr;
  if (!scene.empty()) {
    frame_->begin_scene(scene, burr);
    if (ghost_) ghost_->draw(view_, settings_.section);
    draw_burr(state);
    if (detail_ == Detail::kCoarse) {
      frame_->skip_smooth(scene);
    } else {
      // An edge is followed for so many pixels.
      constexpr int kSmoothReach = 10;
      frame_->begin_smooth(scene.grown(kSmoothReach, width, height));
      smooth_program_.use();
      smooth_program_.set("picture", 0);
      glBindVertexArray(background_array_);
      glDrawArrays(GL_TRIANGLES, 0, 3);
    }
  }
  frame_->begin_picture();
  if (!hud_parts_.any() && state.contact_marks.empty()) return;
  if (!hud_) hud_.emplace(height);
  const std::optional<ColourScale>& colours = surface().colour_scale();
  hud_->draw(state, width, height, view_, hud_parts_, colours ? &*colours : nullptr);
}

void GlScene::draw_background() {
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  glClear(GL_DEPTH_BUFFER_BIT);
  background_program_.use();
  glBindVertexArray(background_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void GlScene::draw_burr(const FrameState& state) {
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  if (state.burr_shown) {
    burr_.draw(view_, state.world_from_tool, state.burr_turn_rad, shows_handpiece(state));
  }
  glDisable(GL_DEPTH_TEST);
  if (state.device) {
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    burr_.draw(view_, *state.device, state.burr_turn_rad, false, kGhost);
    glDisable(GL_BLEND);
  }
  glDisable(GL_CULL_FACE);
}

std::size_t GlScene::triangle_count() const {
  std::size_t count = 0;
  for (const auto& body : bodies_) count += body->triangle_count();
  return count;
}

std::size_t GlScene::memory_bytes() const {
  const std::size_t pixels = static_cast<std::size_t>(frame_->width()) * frame_->height();
  std::size_t bytes = burr_.bytes() + pixels * 24;
  for (const auto& body : bodies_) bytes += body->memory_bytes();
  return bytes;
}

}  // namespace sulcus
