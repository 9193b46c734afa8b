#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/session/session.hpp"

namespace sulcus {

/// summary.json of a run, with the pinned keys of the README. `workpiece` is what is left at the
/// end, `workpiece_start` what there was before the first tick of all; ticks and stages are timed
/// by the thread's own time; numbers have seven digits, energies all. Of a run that goes on from
/// another, `outcome` and `goal` mark the whole, `since_fork` its own part, `parent` says from what
/// it goes on.
nlohmann::ordered_json make_summary(const Simulation& simulation, const SessionResult& result,
                                    const SessionOptions& options,
                                    const std::vector<PartUse>& loading);

/// What the tooth and the hand have had of a cut. A tissue that the scene does not name has no
/// keys; what did not happen is null.
nlohmann::ordered_json outcome_json(const Scene& scene, const OutcomeResult& outcome);
/// How well the scene's goal was met.
nlohmann::ordered_json goal_json(const Scene& scene, const GoalFigures& goal);

}  // namespace sulcus
