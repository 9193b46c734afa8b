#include "app/playback/film_colours.hpp"

#include <stdexcept>

#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/normals/normal_errors.hpp"
#include "engine/outcome/goal.hpp"

namespace sulcus {

namespace {

VoxelSet removed_voxels(const VoxelGrid& grid, std::span<const Edit> edits) {
  VoxelSet removed(grid);
  for (const Edit& edit : edits) {
    if (edit.body == 0 && edit.is_gone()) removed.insert(grid.cell_of_linear(edit.voxel));
  }
  return removed;
}

}  // namespace

ColourScale goal_scale(double end_m) {
  const std::string end = formatted(" > %g mm", end_m / kMillimetre);
  return {.name = "Distance from the planned cavity wall",
          .low = -end_m,
          .high = end_m,
          .unit = kMillimetre,
          .end_low = "not cut" + end,
          .end_high = "over-cut" + end,
          .kind = ColourScale::Kind::kAroundZero,
          .unlit = true};
}

namespace {

ColourScale contact_count_scale() {
  return {.name = "Ticks in contact",
          .low = 1.0,
          .high = 1000.0,
          .beyond_high = "and more",
          .kind = ColourScale::Kind::kDecades};
}

ColourScale normal_error_scale() {
  return {.name = "Normal off by, degrees",
          .high = 10.0 * kDegree,
          .unit = kDegree,
          .beyond_high = "and more"};
}

}  // namespace

VoxelSet recorded_target(const RecordingReader& reader, const std::string& path,
                         const RecordedFilm& film, const std::string& option) {
  if (!film.scene().goal) {
    throw InputError(path, option, "goal, of a scene without [goal]",
                     "the recording of a scene with one");
  }
  const std::optional<VoxelModel> from_file = reader.goal();
  return *target_of_goal(film.scene(), film.start(), from_file ? &*from_file : nullptr);
}

FilmColours::FilmColours(const RecordingReader& reader, const std::string& path,
                         const RecordedFilm& film, const FilmColouring& asked, Renderer& renderer)
    : by_(asked.by),
      contact_marks_(asked.contact_marks),
      target_(asked.target),
      section_(asked.section) {
  switch (by_) {
    case ColourBy::kTissue:
      break;
    case ColourBy::kTime:
      renderer.colour_by_time(film.rows().back().time_s);
      break;
    case ColourBy::kGoal:
      if (target_ == nullptr) throw std::invalid_argument("colours by a goal need its target");
      scale_ = goal_scale(asked.goal_scale_m);
      break;
    case ColourBy::kContacts:
      scale_ = contact_count_scale();
      break;
    case ColourBy::kNormalError:
      scale_ = normal_error_scale();
      break;
    case ColourBy::kTemperature:
      heat_.emplace(reader, film.scene(), film.start(), "--colour-by");
      scale_ = temperature_scale(*film.scene().heat);
      break;
  }
  if (by_ == ColourBy::kContacts || contact_marks_) {
    contacts_.emplace(path, by_ == ColourBy::kContacts);
  }
}

void FilmColours::show_goal(std::size_t row, const RecordedFilm& film, Renderer& renderer) const {
  const VoxelSet removed = removed_voxels(film.model().grid, film.edits_before(row));
  renderer.colour_by_values(0, scale_, goal_distances(film.model(), removed, *target_));
}

void FilmColours::show_temperature(std::size_t row, const RecordedFilm& film, Renderer& renderer) {
  heat_->advance(film.rows()[row].time_s);
  renderer.colour_by_values(0, scale_, temperatures(heat_->tooth(), film.model(), section_));
}

void FilmColours::show(std::size_t row, const RecordedFilm& film, Renderer& renderer,
                       FrameState& state) {
  if (contacts_) contacts_->seek_row(row);
  if (by_ == ColourBy::kGoal) show_goal(row, film, renderer);
  if (by_ == ColourBy::kTemperature) show_temperature(row, film, renderer);
  if (by_ == ColourBy::kContacts) {
    for (std::size_t body = 0; body < contacts_->body_count(); ++body) {
      renderer.colour_by_values(body, scale_, contacts_->counts(body));
    }
  }
  if (by_ == ColourBy::kNormalError) {
    renderer.colour_by_values(0, scale_,
                              normal_errors(Workpiece(film.model()), film.scene().haptics));
  }
  if (contact_marks_) {
    state.contact_marks = contacts_->marks();
    state.contact_mark_m = film.model().grid.voxel_m;
  }
}

}  // namespace sulcus
