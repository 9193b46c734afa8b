#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "app/recorded_run.hpp"
#include "app/simulation.hpp"

namespace sulcus {

/// A recorded run as it was after a row, to be gone on with under other settings; `overrides` as of
/// --set. InputError where they would change what the recording holds already, or no intact state
/// leads there. Moves the run's own simulation.
std::unique_ptr<Simulation> simulation_after(RecordedRun& run, std::size_t row,
                                             const std::vector<std::string>& overrides);

/// What the new recording names as its parent.
std::string parent_of(const RecordedRun& run, std::size_t row);

}  // namespace sulcus
