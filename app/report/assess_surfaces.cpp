#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "app/report/assessment.hpp"
#include "app/report/measure_list.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/assessment/insertion_frame.hpp"
#include "engine/assessment/plan_match.hpp"
#include "engine/assessment/preparation_shape.hpp"
#include "engine/core/error.hpp"

namespace sulcus {

namespace {

void check_it_overlies(const ScannedTooth& tooth, const ScannedTooth::Surface& other,
                       const std::string& option, const AssessmentSettings& settings) {
  constexpr double kMostOutside = 0.02;
  const std::optional<double> outside =
      share_outside(tooth.before.mesh, other.mesh, settings.insertion);
  if (!outside) {
    throw InputError(other.file, option,
                     formatted("hardly any tooth, less than %g mm wide", kCoarsePitch_mm),
                     "what is left of that of --before");
  }
  if (*outside <= kMostOutside) return;
  throw InputError(other.file, option,
                   formatted("%.0f %% of it outside of --before", 100.0 * *outside),
                   "the same tooth in the same place");
}

void add_plan(const ScannedTooth& tooth, MeasureList& all) {
  const AssessmentSettings& settings = all.settings();
  check_it_overlies(tooth, *tooth.plan, "--plan", settings);
  const std::optional<PlanMatch> match =
      plan_match(tooth.before.mesh, tooth.after.mesh, tooth.plan->mesh,
                 {.insertion = settings.insertion,
                  .tolerance_mm = settings.tolerance_mm,
                  .pitch_mm = settings.voxel_mm});
  if (!match) {
    throw InputError(tooth.plan->file, "--plan", nothing_removed(), "less tooth than --before");
  }
  const auto add_reach = [&](std::string_view name, const PlacedFigure& reach) {
    AssessedMeasure& measure = all.add(name, reach.value);
    if (reach.value > 0.0) measure.position_m = reach.at_m;
  };
  add_reach("over_mm", match->over_mm);
  add_reach("under_mm", match->under_mm);
  all.add("goal_error_mm", match->error_mm);
  all.add("goal_error_95_mm", match->error_95_mm);
  all.add("within_tolerance", match->within_tolerance);
  all.add("dice", match->dice);
}

}  // namespace

Assessment assess_scanned(const ScannedTooth& tooth, const AssessmentSettings& settings) {
  check_it_overlies(tooth, tooth.after, "--after", settings);
  const std::optional<PreparationShape> shape =
      preparation_shape(tooth.before.mesh, tooth.after.mesh, shape_settings(settings));
  if (!shape) {
    throw InputError(tooth.after.file, "--after", nothing_removed(), "less tooth than --before");
  }
  std::string subject = tooth.before.file + ", " + tooth.after.file;
  if (tooth.plan) subject += ", " + tooth.plan->file;
  MeasureList all(std::move(subject), settings);
  all.add(*shape);
  if (tooth.plan) add_plan(tooth, all);
  return all.finish();
}

}  // namespace sulcus
