#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/playback/edit_cursor.hpp"
#include "app/playback/recorded_run.hpp"
#include "app/playback/whole_run.hpp"
#include "app/report/assessment.hpp"
#include "app/report/measure_list.hpp"
#include "engine/assessment/hand_process.hpp"
#include "engine/assessment/preparation_shape.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/outcome/goal.hpp"
#include "engine/outcome/preparation_outcome.hpp"
#include "engine/outcome/preparation_progress.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "engine/volume/level_changes.hpp"

namespace sulcus {

namespace {

/// All that a run did, in its order, with what came before it.
std::vector<Edit> all_edits(const RecordingReader& reader, const EarlierRun* earlier) {
  std::vector<Edit> edits = earlier ? earlier->edits : std::vector<Edit>{};
  const std::vector<Edit> own = recorded_edits(reader, reader.tick_count() - 1);
  edits.insert(edits.end(), own.begin(), own.end());
  return edits;
}

/// A run from the first tooth on, to be measured.
struct AssessedRun {
  const RecordingReader& reader;
  const Scene& scene;
  const VoxelModel &start, &end;  // the workpiece
  std::span<const Edit> edits;
  std::size_t earlier_edits;  // of those, before the recording's own

  double rate_hz() const { return scene.haptics.rate_hz; }

  /// Where a voxel of any body is, world space, m.
  Eigen::Vector3d place(const Edit& edit) const {
    const VoxelGrid& grid = reader.grids()[edit.body];
    const Eigen::Vector3d centre = grid.centre_world(grid.cell_of_linear(edit.voxel));
    return edit.body == 0 ? centre : scene.bodies[edit.body - 1u].world_from_grid.point(centre);
  }
  void set_place(AssessedMeasure& measure, const std::optional<Edit>& edit) const {
    if (!edit) return;
    measure.tick = edit->tick;
    measure.position_m = place(*edit);
  }
};

/// When what is at a place was cut free: the last tick that took a voxel as near to it as any.
/// `radius_m`: of a disc across the insertion about the place, which ends at walls; 0 of a place
/// on one.
std::optional<std::uint64_t> tick_at(const Eigen::Vector3d& place_m, double radius_m,
                                     const Eigen::Vector3d& insertion, const AssessedRun& run) {
  double nearest = std::numeric_limits<double>::infinity();
  const double voxel_m = run.start.grid.voxel_m;
  const double beside_m = radius_m > 0.0 ? voxel_m : 0.5 * voxel_m;
  const auto distance = [&](const Edit& edit) {
    const Eigen::Vector3d from = run.place(edit) - place_m;
    const double along = from.dot(insertion);
    return std::hypot((from - along * insertion).norm() - radius_m, along);
  };
  const auto counts = [](const Edit& edit) { return edit.body == 0 && edit.is_gone(); };
  for (const Edit& edit : run.edits) {
    if (counts(edit)) nearest = std::min(nearest, distance(edit));
  }
  std::optional<std::uint64_t> tick;
  for (const Edit& edit : run.edits) {
    if (counts(edit) && distance(edit) <= nearest + beside_m) tick = edit.tick;
  }
  return tick;
}

/// What went of each tissue, tick by tick.
class RemovalLog {
 public:
  explicit RemovalLog(std::size_t tissues) : before_(tissues) {}
  /// After all edits of a tick.
  void look(std::uint64_t tick, const PreparationProgress& progress, double voxel_mm3) {
    for (std::size_t t = 0; t < before_.size(); ++t) {
      const double now = progress.removed_volume(EditCause::kCut, t) * voxel_mm3;
      if (now > before_[t]) removals_.push_back({tick, t, now - before_[t]});
      before_[t] = now;
    }
  }
  std::span<const HandRemoval> removals() const { return removals_; }

 private:
  std::vector<double> before_;
  std::vector<HandRemoval> removals_;
};

void add_rates(const AssessedRun& run, const RemovalLog& log, MeasureList& all) {
  constexpr std::array<std::array<const char*, 2>, 3> kRates{{{"enamel", "enamel_mm3_per_s"},
                                                              {"dentine", "dentine_mm3_per_s"},
                                                              {"caries", "caries_mm3_per_s"}}};
  for (const auto& [tissue, name] : kRates) {
    const auto at = std::ranges::find(run.scene.tissues, tissue, &TissueSettings::name);
    if (at == run.scene.tissues.end()) continue;
    const auto index = static_cast<std::size_t>(at - run.scene.tissues.begin());
    if (const double rate = removal_rate(log.removals(), index, run.rate_hz()); rate > 0.0) {
      all.add(name, rate);
    }
  }
}

/// What the edits did to the tissues, and to the neighbours.
void add_tissues(const AssessedRun& run, MeasureList& all) {
  PreparationProgress progress(run.start, run.scene.tissues);
  RemovalLog log(run.scene.tissues.size());
  const double voxel_mm3 = run.start.grid.voxel_volume_m3() * 1e9;
  double wall_m = std::numeric_limits<double>::infinity();
  std::optional<Edit> nearest, pulp;
  for (std::size_t i = 0; i < run.edits.size(); ++i) {
    const Edit& edit = run.edits[i];
    const bool last_of_tick = i + 1 == run.edits.size() || run.edits[i + 1].tick != edit.tick;
    if (edit.body == 0) {
      const double pulp_before = progress.has_pulp() ? progress.pulp_removed() : 0.0;
      progress.add(edit);
      const auto wall = progress.has_pulp() ? progress.wall_over_pulp_m() : std::nullopt;
      if (wall && *wall < wall_m) {
        wall_m = *wall;
        nearest = edit;
      }
      if (!pulp && progress.has_pulp() && progress.pulp_removed() > pulp_before) pulp = edit;
    }
    if (last_of_tick) log.look(edit.tick, progress, voxel_mm3);
  }
  if (nearest) run.set_place(all.add("dentine_over_pulp_mm", wall_m / kMillimetre), nearest);
  if (progress.has_pulp()) {
    run.set_place(all.add("pulp_removed_mm3", progress.pulp_removed() * voxel_mm3), pulp);
  }
  if (const auto left = progress.caries_left()) all.add("caries_left_mm3", *left * voxel_mm3);
  double sound = 0.0;
  for (std::size_t t = 0; t < run.scene.tissues.size(); ++t) {
    const std::string& name = run.scene.tissues[t].name;
    if (name == "caries" || name == "pulp") continue;
    sound +=
        progress.removed_volume(EditCause::kCut, t) + progress.removed_volume(EditCause::kLoose, t);
  }
  all.add("sound_removed_mm3", sound * voxel_mm3);
  add_rates(run, log, all);
}

/// What was taken of other bodies. Of fractions by their levels; what is known of those before a
/// run that was gone on from is that they were solid.
void add_neighbours(const AssessedRun& run, MeasureList& all) {
  if (run.scene.bodies.empty()) return;
  std::vector<LevelChanges> levels;
  levels.reserve(run.scene.bodies.size());
  for (const VoxelModel& body : run.reader.bodies()) levels.emplace_back(body);
  std::map<std::pair<std::uint16_t, std::uint32_t>, FillLevel> earlier;  // left, of body and voxel
  double removed_mm3 = 0.0;
  std::optional<Edit> first;
  for (std::size_t i = 0; i < run.edits.size(); ++i) {
    const Edit& edit = run.edits[i];
    if (edit.body == 0) continue;
    if (!first) first = edit;
    FillLevel before = kFullLevel;
    if (i < run.earlier_edits) {
      FillLevel& left = earlier.try_emplace({edit.body, edit.voxel}, kFullLevel).first->second;
      before = std::exchange(left, edit.level);
    } else {
      before = levels[edit.body - 1u].before(edit);
    }
    removed_mm3 += run.reader.grids()[edit.body].voxel_volume_m3() * 1e9 *
                   static_cast<double>(before - edit.level) / kFullLevel;
  }
  run.set_place(all.add("neighbour_removed_mm3", removed_mm3), first);
}

/// Distances of the cut from the goal's wall.
void add_errors(std::vector<double> off_mm, MeasureList& all) {
  if (off_mm.empty()) return;
  const auto count = static_cast<double>(off_mm.size());
  const double tolerance_mm = all.settings().tolerance_mm;
  all.add("goal_error_mm", std::accumulate(off_mm.begin(), off_mm.end(), 0.0) / count);
  all.add("within_tolerance", static_cast<double>(std::ranges::count_if(
                                  off_mm, [&](double mm) { return mm <= tolerance_mm; })) /
                                  count);
  const auto last = static_cast<std::ptrdiff_t>(std::ceil(0.95 * (count - 1.0)));
  std::ranges::nth_element(off_mm, off_mm.begin() + last);
  all.add("goal_error_95_mm", off_mm[static_cast<std::size_t>(last)]);
}

/// How well the goal was met, by what the whole run removed.
void add_goal(const AssessedRun& run, MeasureList& all) {
  const std::optional<VoxelModel> file = run.reader.goal();
  const auto target = target_of_goal(run.scene, run.start, file ? &*file : nullptr);
  if (!target) return;
  PreparationOutcome outcome(run.start, run.scene.tissues, target);
  for (const Edit& edit : run.edits) outcome.add(edit);
  const GoalFigures figures = *outcome.goal_figures(run.end);
  const auto add_reach = [&](std::string_view name, const Reach& reach) {
    all.add(name, reach.max_m / kMillimetre).position_m = reach.furthest_m;
  };
  add_reach("over_mm", figures.excess);
  if (figures.missing) add_reach("under_mm", *figures.missing);
  std::vector<double> off_mm;
  const VoxelValues distances = goal_distances(run.end, outcome.removed(), *target);
  for (const auto& [leaf, block] : distances.blocks()) {
    for (const float value : block) {
      if (!std::isnan(value)) off_mm.push_back(std::abs(static_cast<double>(value)) / kMillimetre);
    }
  }
  add_errors(std::move(off_mm), all);
  all.add("dice", figures.dice);
}

std::vector<HandTick> hand_ticks(std::span<const TickRecord> rows) {
  std::vector<HandTick> ticks;
  ticks.reserve(rows.size());
  for (const TickRecord& row : rows) {
    const Pose tool = pose_of(row.tool_position_m, row.tool_orientation);
    ticks.push_back({row.tick, tool.position, tool.direction(Eigen::Vector3d::UnitY()),
                     std::hypot(row.force_N[0], row.force_N[1], row.force_N[2]), row.contacts > 0});
  }
  return ticks;
}

/// What the hand did, by the ticks of the whole run.
void add_hand(const AssessedRun& run, const WholeRun& whole, MeasureList& all) {
  const std::vector<HandTick> ticks = hand_ticks(whole.rows);
  const MeasureLimit* const most = all.limit_of("force_N");
  const bool has_most = most && most->high;
  const HandProcess hand = hand_process(
      ticks, run.rate_hz(), has_most ? *most->high : std::numeric_limits<double>::infinity(),
      all.settings().insertion);
  const auto add_at = [&](std::string_view name, const std::optional<HandFigure>& figure) {
    if (!figure) return;
    AssessedMeasure& measure = all.add(name, figure->value);
    measure.tick = ticks[figure->at].tick;
    measure.position_m = ticks[figure->at].tip_m;
  };
  add_at("force_N", hand.greatest_force_N);
  all.add("median_force_N", hand.median_force_N);
  all.add("p95_force_N", hand.p95_force_N);
  if (has_most) all.add("over_force_s", hand.over_force_s);
  all.add("burr_angle_deg", hand.burr_angle_deg);
  add_at("greatest_burr_angle_deg", hand.greatest_burr_angle_deg);
  all.add("strokes", static_cast<double>(hand.strokes));
  if (hand.strokes > 0) {
    all.add("stroke_s", hand.stroke_s);
    all.add("stroke_mm", hand.stroke_mm);
    all.add("strokes_per_s", hand.strokes_per_s);
  }
  all.add("path_mm", hand.path_mm);
  all.add("pauses", static_cast<double>(hand.pauses));
  all.add("longest_pause_s", hand.longest_pause_s);
  all.add("smoothness", hand.smoothness);
  all.add("burrs", static_cast<double>(whole.burrs));
}

/// What the hand did, as far as a recording knows of it that was gone on from.
RunMeasures add_sums(const AssessedRun& run, std::span<const TickRecord> rows,
                     const EarlierRun* earlier, MeasureList& all) {
  RunMeasures measures = earlier ? earlier->measures : RunMeasures{};
  for (const TickRecord& row : rows) measures.add(row, nullptr);
  all.add("mean_force_N", measures.mean_force_in_contact_N());
  all.add("time_s", static_cast<double>(measures.ticks) / run.rate_hz());
  all.add("contact_s", static_cast<double>(measures.ticks_in_contact) / run.rate_hz());
  return measures;
}

/// What the hand did at the tick that decided a measure.
void add_moment(std::span<const TickRecord> rows, const Eigen::Vector3d& insertion,
                AssessedMeasure& measure) {
  const auto row = std::ranges::lower_bound(rows, *measure.tick, {}, &TickRecord::tick);
  if (row == rows.end() || row->tick != *measure.tick) return;
  const HandTick hand = hand_ticks(std::span(&*row, 1)).front();
  measure.moment = {hand.force_N, burr_angle_deg(hand.axis, insertion), hand.tip_m};
}

}  // namespace

std::optional<Assessment> assessment_if_cut(const RecordingReader& reader, const std::string& path,
                                            const AssessmentSettings& settings) {
  const Scene scene = recorded_scene(reader, path);
  const std::shared_ptr<const EarlierRun> earlier = recorded_earlier(reader, scene);
  VoxelModel end = recorded_workpiece(reader, scene);
  const VoxelModel start = earlier ? earlier->start : end;
  RecordedShape shape_now(reader, std::move(end));
  if (shape_now.rows().empty()) throw InputError(path, "/ticks", "no rows", "at least one tick");
  shape_now.seek_row(shape_now.rows().size() - 1);
  const std::optional<PreparationShape> shape = preparation_shape(
      closed_surface(start), closed_surface(shape_now.model()), shape_settings(settings));
  if (!shape) return {};
  const std::vector<Edit> edits = all_edits(reader, earlier.get());
  const AssessedRun run{
      reader, scene, start, shape_now.model(), edits, earlier ? earlier->edits.size() : 0};
  MeasureList all(path, settings);
  all.add(*shape);
  add_goal(run, all);
  for (AssessedMeasure& measure : all.measures()) {
    if (!measure.position_m) continue;
    // The place of a width is the middle between walls.
    const bool is_width = measure.name == "isthmus_mm" || measure.name == "width_mm";
    const double radius_m = is_width ? 0.5 * kMillimetre * measure.value : 0.0;
    measure.tick = tick_at(*measure.position_m, radius_m, settings.insertion, run);
  }
  add_tissues(run, all);
  add_neighbours(run, all);
  const RunMeasures sums = add_sums(run, shape_now.rows(), earlier.get(), all);
  const std::optional<WholeRun> whole = whole_run(reader);
  if (whole) {
    add_hand(run, *whole, all);
  } else {
    all.add("force_N", sums.peak_force_N);  // the rest is not known
  }
  for (AssessedMeasure& measure : all.measures()) {
    if (!measure.tick) continue;
    measure.time_s = static_cast<double>(*measure.tick) / run.rate_hz();
    add_moment(whole ? whole->rows : shape_now.rows(), settings.insertion, measure);
  }
  return all.finish();
}

Assessment assess_recording(const RecordingReader& reader, const std::string& path,
                            const AssessmentSettings& settings) {
  std::optional<Assessment> assessment = assessment_if_cut(reader, path, settings);
  if (!assessment) throw InputError(path, "/edits", nothing_removed(), "a preparation to assess");
  return *std::move(assessment);
}

}  // namespace sulcus
