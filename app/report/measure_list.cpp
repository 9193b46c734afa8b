#include "app/report/measure_list.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/terminal/terminal.hpp"
#include "engine/assessment/insertion_frame.hpp"

namespace sulcus {

namespace {

/// What every preparation of a kind has: one in which it is not to be found has not met its limit.
bool is_of_every(AssessedKind kind, std::string_view name) {
  if (name == "depth_mm") return true;
  if (kind == AssessedKind::kCrown) return name == "margin_mm";
  return name == "isthmus_mm" || name == "wall_left_mm";
}

}  // namespace

std::string nothing_removed() {
  return formatted("nothing removed that is deeper than %g mm", kSame_mm);
}

AssessedMeasure& MeasureList::add(std::string_view name, double value) {
  AssessedMeasure measure;
  measure.name = name;
  measure.value = value;
  return result_.measures.emplace_back(std::move(measure));
}

void MeasureList::add(std::string_view name, const std::optional<double>& value) {
  if (value) add(name, *value);
}

void MeasureList::add(std::string_view name, const std::optional<PlacedFigure>& figure) {
  if (figure && std::isfinite(figure->value)) add(name, figure->value).position_m = figure->at_m;
}

void MeasureList::add(const PreparationShape& shape) {
  add("depth_mm", shape.depth_mm);
  const MeasureLimit* const depth = limit_of("depth_mm");
  if (shape.depth_mm && depth && depth->low && shape.depth_mm->value < *depth->low) {
    measures().back().position_m = shape.least_depth_mm->at_m;
  }
  add("greatest_depth_mm", shape.greatest_depth_mm);
  add("floor_flatness_um", shape.floor_flatness_um);
  add("convergence_deg", shape.convergence_deg);
  constexpr std::array kWalls{"wall_mesial_deg", "wall_distal_deg", "wall_buccal_deg",
                              "wall_lingual_deg"};  // as ToothSide
  for (std::size_t side = 0; side < kWalls.size(); ++side) add(kWalls[side], shape.wall_deg[side]);
  AssessedMeasure& undercut = add("undercut_mm2", shape.undercut_mm2.value);
  if (undercut.value > 0.0) undercut.position_m = shape.undercut_mm2.at_m;
  add("isthmus_mm", shape.isthmus_mm);
  add("width_mm", shape.width_mm);
  add("margin_mm", shape.margin_mm);
  add("margin_slope_deg", shape.margin_slope_deg);
  add("roughness_um", shape.roughness_um);
  add("greatest_roughness_um", shape.greatest_roughness_um);
  add("wall_left_mm", shape.wall_left_mm);
}

const MeasureLimit* MeasureList::limit_of(std::string_view name) const {
  const auto found = std::ranges::find(settings_.limits, name, &MeasureLimit::name);
  return found == settings_.limits.end() ? nullptr : &*found;
}

Assessment MeasureList::finish() {
  const auto rank = [](const AssessedMeasure& measure) {
    return std::ranges::find(measure_names(), measure.name, &MeasureName::name) -
           measure_names().begin();
  };
  std::ranges::stable_sort(result_.measures, {}, rank);
  for (AssessedMeasure& measure : result_.measures) {
    measure.unit = measure_names()[static_cast<std::size_t>(rank(measure))].unit;
  }
  double met = 0.0, all = 0.0;
  for (const MeasureLimit& limit : settings_.limits) {
    const auto measure = std::ranges::find(result_.measures, limit.name, &AssessedMeasure::name);
    if (measure == result_.measures.end()) {
      result_.not_measured.push_back(limit.name);
      if (is_of_every(settings_.kind, limit.name)) all += limit.weight;
      continue;
    }
    measure->limit = limit;
    all += limit.weight;
    if (measure->met()) met += limit.weight;
  }
  if (all > 0.0) result_.mark = 100.0 * met / all;
  return std::move(result_);
}

}  // namespace sulcus
