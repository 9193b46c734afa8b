#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/playback/recorded_run.hpp"
#include "app/session/simulation.hpp"
#include "engine/tool/burr.hpp"

namespace sulcus {

/// Whether an override (as of --set) is one of another burr than the recorded one.
bool asks_for_a_burr(const std::string& override_text);

/// A recorded run as it was after a row, to be gone on with under other settings; `overrides` as of
/// --set. `burr`: another one, where they ask for that; none: the recorded one. InputError where
/// they would change what the recording holds already, no intact state leads there, or the other
/// burr's head would be inside the solid. Moves the run's own simulation.
std::unique_ptr<Simulation> simulation_after(RecordedRun& run, std::size_t row,
                                             const std::vector<std::string>& overrides,
                                             std::optional<Burr> burr = {});

/// What came before a run that goes on after a row, from the first tick of all. Before
/// simulation_after.
std::shared_ptr<const EarlierRun> earlier_of(const RecordedRun& run, std::size_t row);

/// What the new recording names as its parent.
std::string parent_of(const RecordedRun& run, std::size_t row);

}  // namespace sulcus
