#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "app/playback/recorded_run.hpp"
#include "app/session/simulation.hpp"
#include "engine/recording/earlier_run.hpp"

namespace sulcus {

/// A run that goes on from a recorded one.
struct ContinuedRun {
  std::unique_ptr<Simulation> simulation;
  std::shared_ptr<const EarlierRun> earlier;  // what came before it, from the first tick of all
  std::string parent;                         // what the new recording names as that
};

/// A recorded run as it was after a row, to go on under other settings; `overrides` as of --set.
/// InputError where they would change what the recording holds already, no intact state leads
/// there, as load_burr where they name another burr, or where its head would be inside the solid.
/// Moves the run's own simulation.
ContinuedRun continue_run(RecordedRun& run, std::size_t row,
                          const std::vector<std::string>& overrides);

/// Whether an override puts another burr in the place of the recorded one.
bool is_other_burr(const std::string& override_text);

}  // namespace sulcus
