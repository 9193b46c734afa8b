#pragma once

#include <string>

#include "app/session/run_statistics.hpp"
#include "app/session/simulation.hpp"

namespace sulcus {

/// What to say of a run that touched nothing: how near the burr came to the workpiece, when, and
/// where its tip was then; from a hundred ticks of the run, to about a voxel. Empty where it
/// touched. Walks the volume: after a run only.
std::string say_untouched(const Simulation& simulation, const RunStatistics& statistics);

}  // namespace sulcus
