#pragma once

#include <optional>
#include <vector>

#include "engine/outcome/preparation_outcome.hpp"
#include "engine/recording/earlier_run.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// What a run with [cutting] is marked by: what its edits do to the tooth, and its ticks to the
/// hand. Used by one thread.
struct RunMarks {
  PreparationOutcome preparation;
  RunMeasures measures;
};

/// Marks at the end of a run.
struct OutcomeResult {
  PreparationProgress progress;
  std::optional<GoalFigures> goal;
  RunMeasures measures;
};

/// Before the first tick. `start`: the workpiece then; `goal`: what the file of the scene's goal
/// holds, null where it names none. Of a run that goes on from another, `earlier` is what came
/// before: the first marks are the whole's, from the first tooth on, and a second the part's own,
/// without a goal. InputError as target_of_goal.
std::vector<RunMarks> begin_marks(const Scene& scene, const VoxelModel& start,
                                  const VoxelModel* goal, const EarlierRun* earlier);

/// `end`: the workpiece after the last tick.
OutcomeResult end_marks(const RunMarks& marks, const VoxelModel& end);

}  // namespace sulcus
