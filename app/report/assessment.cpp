#include "app/report/assessment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include <nlohmann/json.hpp>

#include "app/playback/recorded_run.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/assessment/preparation_shape.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/outcome/preparation_progress.hpp"
#include "engine/surface/surface_mesh.hpp"

namespace sulcus {

namespace {

using Json = nlohmann::ordered_json;

class Collector {
 public:
  Collector(std::string subject, const AssessmentSettings& settings) : settings_(settings) {
    result_.subject = std::move(subject);
  }

  AssessedMeasure& add(std::string_view name, double value) {
    AssessedMeasure measure;
    measure.name = name;
    measure.value = value;
    return result_.measures.emplace_back(std::move(measure));
  }
  void add(std::string_view name, const std::optional<PlacedFigure>& figure) {
    if (figure) add(name, figure->value).position_m = figure->at_m;
  }
  void add_shape(const PreparationShape& shape) {
    add("depth_mm", shape.depth_mm);
    add("greatest_depth_mm", shape.greatest_depth_mm);
    add("floor_flatness_um", shape.floor_flatness_um);
    add("convergence_deg", shape.convergence_deg);
    AssessedMeasure& undercut = add("undercut_mm2", shape.undercut_mm2.value);
    if (undercut.value > 0.0) undercut.position_m = shape.undercut_mm2.at_m;
    add("isthmus_mm", shape.isthmus_mm);
    add("width_mm", shape.width_mm);
    add("margin_mm", shape.margin_mm);
    add("roughness_um", shape.roughness_um);
    add("wall_left_mm", shape.wall_left_mm);
  }
  std::vector<AssessedMeasure>& measures() { return result_.measures; }

  Assessment finish() {
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
        continue;
      }
      measure->limit = limit;
      all += limit.weight;
      if (measure->met()) met += limit.weight;
    }
    if (all > 0.0) result_.mark = 100.0 * met / all;
    return std::move(result_);
  }

 private:
  const AssessmentSettings& settings_;
  Assessment result_;
};

ShapeSettings shape_settings(const AssessmentSettings& settings) {
  return {.kind = settings.kind, .insertion = settings.insertion};
}

/// All that a run did, in its order, with what came before it.
std::vector<Edit> all_edits(const RecordingReader& reader, const EarlierRun* earlier) {
  std::vector<Edit> edits = earlier ? earlier->edits : std::vector<Edit>{};
  const std::vector<Edit> own = reader.edits();
  edits.insert(edits.end(), own.begin(), own.end());
  return edits;
}

/// When what is at a place was cut free: the last tick that took a voxel as near to it as any.
std::optional<std::uint64_t> tick_at(const Eigen::Vector3d& place_m, std::span<const Edit> edits,
                                     const VoxelGrid& grid) {
  double nearest = std::numeric_limits<double>::infinity();
  const auto distance = [&](const Edit& edit) {
    return (grid.centre_world(grid.cell_of_linear(edit.voxel)) - place_m).norm();
  };
  const auto counts = [](const Edit& edit) { return edit.body == 0 && edit.is_gone(); };
  for (const Edit& edit : edits) {
    if (counts(edit)) nearest = std::min(nearest, distance(edit));
  }
  std::optional<std::uint64_t> tick;
  for (const Edit& edit : edits) {
    if (counts(edit) && distance(edit) <= nearest + 0.5 * grid.voxel_m) tick = edit.tick;
  }
  return tick;
}

/// What the edits did to the tissues.
void add_tissues(Collector& all, const Scene& scene, const VoxelModel& start,
                 std::span<const Edit> edits) {
  PreparationProgress progress(start, scene.tissues);
  const double voxel_mm3 = start.grid.voxel_volume_m3() * 1e9;
  double wall_m = std::numeric_limits<double>::infinity();
  std::optional<Edit> nearest, pulp, neighbour;
  double neighbour_mm3 = 0.0;
  for (const Edit& edit : edits) {
    if (edit.body > 0) {
      if (!edit.is_gone()) continue;
      if (!neighbour) neighbour = edit;
      const double edge_m = scene.bodies[edit.body - 1u].solid.voxel_m;
      neighbour_mm3 += edge_m * edge_m * edge_m * 1e9;
      continue;
    }
    const double pulp_before = progress.has_pulp() ? progress.pulp_removed() : 0.0;
    progress.add(edit);
    if (!progress.has_pulp()) continue;
    if (const auto wall = progress.wall_over_pulp_m(); wall && *wall < wall_m) {
      wall_m = *wall;
      nearest = edit;
    }
    if (!pulp && progress.pulp_removed() > pulp_before) pulp = edit;
  }
  const auto place = [&](AssessedMeasure& measure, const std::optional<Edit>& edit) {
    if (!edit) return;
    measure.tick = edit->tick;
    if (edit->body == 0) {
      measure.position_m = start.grid.centre_world(start.grid.cell_of_linear(edit->voxel));
    }
  };
  if (nearest) place(all.add("dentine_over_pulp_mm", wall_m / kMillimetre), nearest);
  if (progress.has_pulp()) {
    place(all.add("pulp_removed_mm3", progress.pulp_removed() * voxel_mm3), pulp);
  }
  if (const auto left = progress.caries_left()) all.add("caries_left_mm3", *left * voxel_mm3);
  double sound = 0.0;
  for (std::size_t t = 0; t < scene.tissues.size(); ++t) {
    if (scene.tissues[t].name == "caries" || scene.tissues[t].name == "pulp") continue;
    sound +=
        progress.removed_volume(EditCause::kCut, t) + progress.removed_volume(EditCause::kLoose, t);
  }
  all.add("sound_removed_mm3", sound * voxel_mm3);
  if (!scene.bodies.empty()) place(all.add("neighbour_removed_mm3", neighbour_mm3), neighbour);
}

/// What the hand did.
void add_process(Collector& all, const Scene& scene, const std::vector<TickRecord>& rows,
                 const EarlierRun* earlier) {
  RunMeasures measures = earlier ? earlier->measures : RunMeasures{};
  const TickRecord* strongest = nullptr;
  for (const TickRecord& row : rows) {
    const double before_N = measures.peak_force_N;
    measures.add(row, nullptr);
    if (measures.peak_force_N > before_N) strongest = &row;
  }
  AssessedMeasure& force = all.add("force_N", measures.peak_force_N);
  if (strongest) {
    force.tick = strongest->tick;
    force.position_m = Eigen::Vector3d(strongest->tool_position_m);
  }
  all.add("mean_force_N", measures.mean_force_in_contact_N());
  all.add("time_s", static_cast<double>(measures.ticks) / scene.haptics.rate_hz);
  all.add("contact_s", static_cast<double>(measures.ticks_in_contact) / scene.haptics.rate_hz);
}

/// How well the goal was met, as the run's summary has it; nothing where it has none.
void add_goal(Collector& all, const std::optional<std::string>& summary) {
  if (!summary) return;
  const Json parsed = Json::parse(*summary, nullptr, false);
  if (!parsed.is_object() || !parsed.contains("goal")) return;
  const Json& goal = parsed["goal"];
  const auto greatest = [&](const char* key) -> std::optional<double> {
    const auto found = goal.find(key);
    if (found == goal.end() || !found->is_object() || !found->contains("max")) return {};
    return found->at("max").get<double>();
  };
  if (const auto over = greatest("excess_beyond_mm")) all.add("over_mm", *over);
  if (const auto under = greatest("missing_within_mm")) all.add("under_mm", *under);
  if (goal.contains("dice") && goal["dice"].is_number()) all.add("dice", goal["dice"]);
}

Json limit_json(const std::optional<MeasureLimit>& limit) {
  if (!limit) return nullptr;
  const auto end = [](const std::optional<double>& v) { return v ? Json(*v) : Json(nullptr); };
  return Json::array({end(limit->low), end(limit->high)});
}

std::string limit_text(const MeasureLimit& limit) {
  if (limit.low && limit.high) return formatted("%g to %g", *limit.low, *limit.high);
  return limit.low ? formatted(">= %g", *limit.low) : formatted("<= %g", *limit.high);
}

}  // namespace

Assessment assess_recording(const RecordingReader& reader, const std::string& path,
                            const AssessmentSettings& settings) {
  const Scene scene = recorded_scene(reader, path);
  const std::shared_ptr<const EarlierRun> earlier = recorded_earlier(reader, scene);
  VoxelModel end = recorded_workpiece(reader, scene);
  const VoxelModel start = earlier ? earlier->start : end;
  RecordedShape shape_now(reader, std::move(end));
  if (shape_now.rows().empty()) {
    throw InputError(path, "/ticks", "no rows", "at least one tick");
  }
  shape_now.seek_row(shape_now.rows().size() - 1);
  const std::optional<PreparationShape> shape = preparation_shape(
      closed_surface(start), closed_surface(shape_now.model()), shape_settings(settings));
  if (!shape) throw InputError(path, "/edits", "nothing removed", "a preparation to assess");
  const std::vector<Edit> edits = all_edits(reader, earlier.get());
  Collector all(path, settings);
  all.add_shape(*shape);
  for (AssessedMeasure& measure : all.measures()) {
    if (measure.position_m) measure.tick = tick_at(*measure.position_m, edits, start.grid);
  }
  add_tissues(all, scene, start, edits);
  add_process(all, scene, shape_now.rows(), earlier.get());
  add_goal(all, reader.summary());
  for (AssessedMeasure& measure : all.measures()) {
    if (measure.tick) {
      measure.time_s = static_cast<double>(*measure.tick) / scene.haptics.rate_hz;
    }
  }
  return all.finish();
}

Assessment assess_meshes(const TriangleMesh& before, const TriangleMesh& after,
                         const std::array<std::string, 2>& names,
                         const AssessmentSettings& settings) {
  constexpr double kMostOutside = 0.02;
  if (const double outside = share_outside(before, after, settings.insertion);
      outside > kMostOutside) {
    throw InputError(names[1], "--after",
                     formatted("%.0f %% of it outside of --before", 100.0 * outside),
                     "the same tooth in the same place");
  }
  const std::optional<PreparationShape> shape =
      preparation_shape(before, after, shape_settings(settings));
  if (!shape) {
    throw InputError(names[1], "--after", "nothing removed", "less tooth than --before");
  }
  Collector all(names[0] + ", " + names[1], settings);
  all.add_shape(*shape);
  return all.finish();
}

std::optional<double> value_of(const Assessment& assessment, std::string_view name) {
  const auto found = std::ranges::find(assessment.measures, name, &AssessedMeasure::name);
  if (found == assessment.measures.end()) return {};
  return found->value;
}

std::string assessment_json(const Assessment& assessment) {
  Json measures = Json::array();
  for (const AssessedMeasure& measure : assessment.measures) {
    Json position = nullptr;
    if (measure.position_m) {
      const Eigen::Vector3d mm = *measure.position_m / kMillimetre;
      position = Json::array({mm.x(), mm.y(), mm.z()});
    }
    measures.push_back({{"name", measure.name},
                        {"value", measure.value},
                        {"unit", measure.unit},
                        {"limit", limit_json(measure.limit)},
                        {"met", measure.limit ? Json(measure.met()) : Json(nullptr)},
                        {"position_mm", position},
                        {"tick", measure.tick ? Json(*measure.tick) : Json(nullptr)},
                        {"time_s", measure.time_s ? Json(*measure.time_s) : Json(nullptr)}});
  }
  const Json all{{"subject", assessment.subject},
                 {"mark", assessment.mark ? Json(*assessment.mark) : Json(nullptr)},
                 {"measures", measures},
                 {"not_measured", assessment.not_measured}};
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<std::string> assessment_lines(const Assessment& assessment) {
  std::vector<std::string> lines;
  for (const AssessedMeasure& measure : assessment.measures) {
    std::string line =
        formatted("  %-22s %9.3f %-4s", measure.name.c_str(), measure.value, measure.unit.c_str());
    if (measure.limit) {
      line += formatted("  %-14s %s", limit_text(*measure.limit).c_str(),
                        measure.met() ? "met" : "NOT MET");
      if (!measure.met() && measure.time_s) line += formatted(", at %.2f s", *measure.time_s);
      if (!measure.met() && measure.position_m) {
        const Eigen::Vector3d mm = *measure.position_m / kMillimetre;
        line += formatted(", at %.2f %.2f %.2f mm", mm.x(), mm.y(), mm.z());
      }
    }
    lines.push_back(std::move(line));
  }
  for (const std::string& name : assessment.not_measured) {
    lines.push_back(formatted("  %-22s not there to be measured", name.c_str()));
  }
  if (assessment.mark) lines.push_back(formatted("  %-22s %9.0f of 100", "mark", *assessment.mark));
  return lines;
}

}  // namespace sulcus
