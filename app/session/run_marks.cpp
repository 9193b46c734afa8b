#include "app/session/run_marks.hpp"

#include "engine/outcome/goal.hpp"

namespace sulcus {

std::vector<RunMarks> begin_marks(const Scene& scene, const VoxelModel& start,
                                  const VoxelModel* goal, const EarlierRun* earlier) {
  const VoxelModel& first = earlier ? earlier->start : start;
  std::vector<RunMarks> marks;
  marks.push_back(
      {PreparationOutcome(first, scene.tissues, target_of_goal(scene, first, goal)), {}});
  if (!earlier) return marks;
  for (const Edit& edit : earlier->edits) marks.front().preparation.add(edit);
  marks.front().measures = earlier->measures;
  marks.push_back({PreparationOutcome(start, scene.tissues, {}), {}});
  return marks;
}

OutcomeResult end_marks(const RunMarks& marks, const VoxelModel& end) {
  const PreparationOutcome& preparation = marks.preparation;
  return {preparation.progress(), preparation.wall_over_pulp_m(), preparation.goal_figures(end),
          marks.measures};
}

}  // namespace sulcus
