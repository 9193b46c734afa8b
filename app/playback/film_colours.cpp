#include "app/playback/film_colours.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

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

VoxelModel without_voxels(VoxelModel model, const VoxelSet& removed) {
  for (const std::uint32_t leaf : removed.leaves()) {
    model.leaves[leaf] = without(model.leaves[leaf], removed.voxels(leaf));
  }
  return model;
}

/// One scale for all times of a recording: what 95 % of the surface does not exceed at its end.
ColourScale goal_scale(const RecordedFilm& film, const VoxelSet& target) {
  const VoxelGrid& grid = film.start().grid;
  const VoxelSet removed = removed_voxels(grid, film.edits_before(film.rows().size() - 1));
  const VoxelValues end = goal_distances(without_voxels(film.start(), removed), removed, target);
  std::vector<float> sizes;
  for (const auto& [leaf, block] : end.blocks()) {
    for (const float value : block) {
      if (!std::isnan(value)) sizes.push_back(std::abs(value));
    }
  }
  double most_m = 2.0 * grid.voxel_m;
  if (!sizes.empty()) {
    const auto p95 = sizes.begin() + static_cast<std::ptrdiff_t>(95 * (sizes.size() - 1) / 100);
    std::nth_element(sizes.begin(), p95, sizes.end());
    most_m = std::max<double>(most_m, *p95);
  }
  const double end_m = round_number_above(most_m / kMillimetre) * kMillimetre;
  return {.name = "Goal's wall, mm",
          .low = -end_m,
          .high = end_m,
          .unit = kMillimetre,
          .beyond_low = "and more, missing",
          .beyond_high = "and more, beyond",
          .kind = ColourScale::Kind::kAroundZero};
}

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

FilmColours::FilmColours(const RecordingReader& reader, const std::string& path,
                         const RecordedFilm& film, ColourBy by, bool contact_marks,
                         std::optional<Section> section, Renderer& renderer)
    : by_(by), contact_marks_(contact_marks), section_(section) {
  switch (by) {
    case ColourBy::kTissue:
      break;
    case ColourBy::kTime:
      renderer.colour_by_time(film.rows().back().time_s);
      break;
    case ColourBy::kGoal: {
      if (!film.scene().goal) {
        throw InputError(path, "--colour-by", "goal, of a scene without [goal]",
                         "the recording of a scene with one");
      }
      const std::optional<VoxelModel> from_file = reader.goal();
      target_ = target_of_goal(film.scene(), film.start(), from_file ? &*from_file : nullptr);
      scale_ = goal_scale(film, *target_);
      break;
    }
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
  if (by == ColourBy::kContacts || contact_marks)
    contacts_.emplace(path, by == ColourBy::kContacts);
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
