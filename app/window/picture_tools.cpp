#include "app/window/picture_tools.hpp"

#include <algorithm>

#include "app/terminal/terminal.hpp"
#include "app/window/view_keys.hpp"
#include "engine/core/units.hpp"
#include "engine/graphics/mirror.hpp"
#include "engine/graphics/view_place.hpp"

namespace sulcus {

namespace {

/// The point of a body that is seen at a place, and what it is of.
std::optional<PickedPoint> point_at(const GlScene& drawing, const Eigen::Vector2d& place,
                                    std::string& tissue) {
  std::optional<PickedPoint> nearest;
  const SightLine line = sight_line(drawing.view(), place);
  for (const GlBody* body : drawing.shown_bodies()) {
    const DrawnSurface& surface = body->surface();
    const auto point =
        picked_point(surface.model(), body->world_from_grid(), line, drawing.view().shown_world);
    if (!point || (nearest && nearest->distance_m <= point->distance_m)) continue;
    nearest = point;
    const auto& looks = surface.looks();
    tissue = looks[std::min<std::size_t>(point->tissue, looks.size() - 1)].name;
  }
  return nearest;
}

/// Whether mesial and buccal mean anything: of a tooth, not of a ball or a plate.
bool is_tooth(const WorkpieceSettings& workpiece) {
  return !workpiece.shape || *workpiece.shape == ShapeKind::kMolar;
}

WindowMargins margins_of(const PictureControls& controls, bool in_recording) {
  return {.left = 286.0f,
          .right = controls.figures ? 268.0f : 20.0f,
          .top = 16.0f,
          .bottom = in_recording ? 66.0f : 20.0f};
}

std::string mm(double metres) { return formatted("%.2f mm", metres / kMillimetre); }

}  // namespace

PictureTools::PictureTools(const Scene& scene, const VoxelModel& start, const Burr& burr,
                           Turns turns)
    : scene_(scene), burr_(burr), turns_(turns), pulp_(start, scene.tissues) {}

void PictureTools::take_key(char key, CameraHand& camera, Window& window, PictureControls& controls,
                            bool in_recording) {
  const std::optional<ViewAction> action = action_of(key, in_recording);
  if (!action) return;
  switch (*action) {
    case ViewAction::kCamera:
      camera.take(camera_of(key).value());
      break;
    case ViewAction::kCopyPlace:
      if (!under_pointer_) break;
      copied_ = place_text(under_pointer_->point_world);
      window.copy(copied_);
      break;
    case ViewAction::kMeasure:
      if (under_pointer_) {
        caliper_.set(under_pointer_->point_world);
      } else {
        caliper_.clear();
      }
      break;
    case ViewAction::kArrows:
      controls.arrows = !controls.arrows;
      break;
    case ViewAction::kFigures:
      controls.figures = !controls.figures;
      break;
    case ViewAction::kSection:
      controls.cut_open = !controls.cut_open;
      break;
    case ViewAction::kPlan:
      controls.plan = controls.has_plan && !controls.plan;
      break;
    case ViewAction::kColourByPlan:
      controls.by_plan = controls.has_plan && !controls.by_plan;
      break;
    case ViewAction::kMirror:
      controls.mirror = !controls.mirror;
      break;
    case ViewAction::kEnd:
      window.close();
      break;
    case ViewAction::kPause:  // of each window
    case ViewAction::kSpindle:
    case ViewAction::kNextBurr:
    case ViewAction::kClutch:
    case ViewAction::kRecentre:
    case ViewAction::kStepBack:
    case ViewAction::kStepOn:
    case ViewAction::kExport:
      break;
  }
}

void PictureTools::follow(const WindowInput& input, const GlScene& drawing, CameraHand& camera,
                          Window& window, PictureControls& controls, bool in_recording) {
  const View& view = drawing.view();
  const int height = window.size().y();
  under_pointer_.reset();
  if (input.pointer) under_pointer_ = point_at(drawing, *input.pointer, tissue_);
  const auto point = under_pointer_ ? std::optional(under_pointer_->point_world) : std::nullopt;
  for (const char key : input.keys) take_key(key, camera, window, controls, in_recording);

  if (input.pressed) grabbed_world_ = point;
  const bool turner = turns_ == Turns::kLeft ? input.left : input.right;
  const bool moves = input.middle || (turner && input.shift);
  if (moves && !input.drag.isZero()) camera.move(input.drag, view, height, grabbed_world_);
  if (turner && !input.shift) camera.turn(input.drag);
  if (input.pointer) camera.zoom(input.wheel, *input.pointer, view, height, point);
  moving_ = moves || turner || input.wheel != 0.0;
}

void PictureTools::add_caliper(const View& view, Overlay& overlay) const {
  if (!caliper_.first()) return;
  const auto first = place_of(view, *caliper_.first());
  if (!caliper_.second()) {
    if (first) overlay.marks.push_back(*first);
    overlay.status.push_back("caliper: d sets the second point");
    return;
  }
  overlay.status.push_back("caliper: " +
                           formatted("%.3f mm", *caliper_.distance_m() / kMillimetre));
  const auto second = place_of(view, *caliper_.second());
  if (!first || !second) return;
  overlay.lines.push_back({*first, *second});
  overlay.labels.push_back({0.5 * (*first + *second) + Eigen::Vector2d(0.0, 0.05),
                            formatted("%.3f mm", *caliper_.distance_m() / kMillimetre)});
}

void PictureTools::add_status(const FrameState& state, Overlay& overlay) const {
  if (under_pointer_) {
    std::string line = tissue_ + "  " + place_text(under_pointer_->point_world) + " mm";
    const auto pulp_m = pulp_.distance_m(under_pointer_->point_world);
    if (pulp_m && tissue_ != "pulp") line += "  pulp at " + mm(*pulp_m);
    overlay.status.push_back(std::move(line));
  }
  if (const auto pulp_m = pulp_.distance_m(burr_, state.world_from_tool)) {
    overlay.status.push_back(*pulp_m > 0.0 ? "burr to pulp " + mm(*pulp_m) : "burr in the pulp");
  }
  if (!copied_.empty()) overlay.status.push_back("copied " + copied_);
}

void PictureTools::draw_over(const GlScene& drawing, const FrameState& state, const Window& window,
                             const PictureControls& controls, bool in_recording) {
  const WindowMargins margins = margins_of(controls, in_recording);
  Overlay overlay;
  add_status(state, overlay);
  add_caliper(drawing.view(), overlay);
  if (is_tooth(scene_.workpiece)) {
    const double height = window.size().y();
    WindowMargins inside = margins;
    for (float* side : {&inside.left, &inside.right, &inside.top, &inside.bottom}) *side += 16.0f;
    for (Overlay::Words& letter :
         side_letters(drawing.view(), window.size().x() / height, height, inside)) {
      overlay.labels.push_back(std::move(letter));
    }
  }
  if (controls.legend && !drawing.surface().colour_scale() && scene_.tissues.size() > 1) {
    for (const TissueLook& look : drawing.surface().looks()) {
      overlay.tissues.push_back({look.name, look.colour});
    }
  }
  WindowMargins of_legend = margins;
  if (mirror_) {
    overlay.inset = {mirror_at_.x(), mirror_at_.y(), mirror_->width(), mirror_->height()};
    of_legend.bottom += static_cast<float>(mirror_->height()) + 14.0f;
  }
  draw_overlay(overlay, of_legend);
}

void PictureTools::end_frame(GlScene& drawing, const FrameState& state, const CameraHand& camera,
                             Window& window, const PictureControls& controls, bool in_recording) {
  mirror_ = controls.mirror ? mirror_ : nullptr;
  if (controls.mirror && --frames_to_mirror_ <= 0) {
    constexpr int kEvery = 3;  // it costs as much as the picture
    frames_to_mirror_ = kEvery;
    const int edge = std::max(120, window.size().y() * 3 / 10);
    const WindowMargins margins = margins_of(controls, in_recording);
    mirror_ = &drawing.draw_mirror(mirror_viewpoint(camera.from(), camera.azimuth_deg(),
                                                    static_cast<double>(controls.mirror_deg)),
                                   state, edge, edge);
    mirror_at_ = {window.size().x() - static_cast<int>(margins.right) - edge,
                  static_cast<int>(margins.bottom)};
  }
  draw_over(drawing, state, window, controls, in_recording);
  window.end(drawing.frame(), mirror_, mirror_at_);
}

}  // namespace sulcus
