#include "engine/scene/assessment_table.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/scene/table_readers.hpp"

namespace sulcus {

namespace {

/// An examiner's, by preparation. Sources: engine/assessment/README.md.
struct Preset {
  std::string_view name;
  AssessedKind kind;
  std::vector<MeasureLimit> limits;
};

const std::array<Preset, 4>& presets() {
  static const std::array<Preset, 4> all{
      {{"class_one",
        AssessedKind::kCavity,
        {{"depth_mm", 1.5, 1.75},
         {"isthmus_mm", 1.0, 1.25},
         {"undercut_mm2", {}, 0.0},
         {"dentine_over_pulp_mm", 0.5, {}}}},
       {"class_two",
        AssessedKind::kCavity,
        {{"depth_mm", 1.0, 1.75},
         {"dentine_over_pulp_mm", 0.5, {}},
         {"neighbour_removed_mm3", {}, 0.0}}},
       {"access", AssessedKind::kCavity, {{"undercut_mm2", {}, 0.0}, {"wall_left_mm", 1.0, {}}}},
       {"crown",
        AssessedKind::kCrown,
        {{"depth_mm", 1.5, 2.2},
         {"convergence_deg", 4.0, 14.0},
         {"undercut_mm2", {}, 0.0},
         {"margin_mm", 1.0, 1.5},
         {"dentine_over_pulp_mm", 0.5, {}},
         {"neighbour_removed_mm3", {}, 0.0}}}}};
  return all;
}

/// Of the measures' order; a later one of the same name stands in for an earlier.
void set_limit(std::vector<MeasureLimit>& limits, MeasureLimit limit) {
  const auto rank = [](std::string_view name) {
    return std::ranges::find(measure_names(), name, &MeasureName::name) - measure_names().begin();
  };
  const auto at = std::ranges::lower_bound(limits, rank(limit.name), {},
                                           [&](const MeasureLimit& l) { return rank(l.name); });
  if (at != limits.end() && at->name == limit.name) {
    *at = std::move(limit);
  } else {
    limits.insert(at, std::move(limit));
  }
}

}  // namespace

AssessmentSettings read_assessment(SceneTable& table) {
  AssessmentSettings settings;
  if (const auto preset = table.choice_if("preset")) {
    settings.kind = presets()[*preset].kind;
    for (const MeasureLimit& limit : presets()[*preset].limits) set_limit(settings.limits, limit);
  }
  if (const auto kind = table.choice_if("kind")) settings.kind = AssessedKind(*kind);
  settings.insertion = table.direction("insertion");
  settings.mesial = table.direction("mesial");
  settings.buccal = table.direction("buccal");
  settings.tolerance_mm = table.number("tolerance_mm");
  settings.voxel_mm = table.number("voxel_mm");
  for (const MeasureName& measure : measure_names()) {
    const std::vector<double> limit = table.limit(measure.name);
    if (limit.empty()) continue;
    MeasureLimit wanted{std::string(measure.name), {}, {}};
    if (limit.size() == 2) {
      wanted.low = limit[0];
      wanted.high = limit[1];
    } else {
      (measure.at_least ? wanted.low : wanted.high) = limit[0];
    }
    set_limit(settings.limits, std::move(wanted));
  }
  if (auto weights = table.table("weights")) {
    for (const MeasureName& measure : measure_names()) {
      const double weight = weights->number(measure.name, 1.0);
      if (!weights->has(measure.name)) continue;
      const auto limit = std::ranges::find(settings.limits, measure.name, &MeasureLimit::name);
      if (limit == settings.limits.end()) {
        weights->fail(measure.name, "a weight without a limit",
                      "one of that name in [assessment] as well");
      }
      limit->weight = weight;
    }
    weights->finish();
  }
  table.finish();
  return settings;
}

std::optional<AssessmentSettings> assessment_of(const std::string& text, const std::string& file) {
  const toml::table parsed = parse_toml(text, file, "an [assessment]");
  SceneTable root(TomlTable(parsed, file, ""), "");
  auto table = root.table("assessment");
  if (!table) return {};
  return read_assessment(*table);
}

}  // namespace sulcus
