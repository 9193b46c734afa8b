#include "app/session/run_marks.hpp"

#include "engine/outcome/goal.hpp"

namespace sulcus {

std::vector<RunMarks> begin_marks(const Scene& scene, const VoxelModel& start,
                                  const VoxelModel* goal, const EarlierRun* earlier) {
  const VoxelModel& first = earlier ? earlier->start : start;
  std::vector<RunMarks> marks;
  const std::optional<double> least_wall_m = scene.least_pulp_distance_m;
  marks.push_back(
      {PreparationOutcome(first, scene.tissues, target_of_goal(scene, first, goal), least_wall_m),
       {}});
  if (!earlier) return marks;
  for (const Edit& edit : earlier->edits) marks.front().preparation.add(edit);
  marks.front().measures = earlier->measures;
  marks.push_back({PreparationOutcome(start, scene.tissues, {}, least_wall_m), {}});
  return marks;
}

OutcomeResult end_marks(const RunMarks& marks, const VoxelModel& end) {
  const PreparationOutcome& preparation = marks.preparation;
  return {preparation.progress(), preparation.goal_figures(end), marks.measures};
}

}  // namespace sulcus
