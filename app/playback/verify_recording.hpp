#pragma once

#include "app/playback/recorded_run.hpp"

namespace sulcus {

/// What was compared.
struct Verified {
  std::size_t rows = 0, edits = 0, fills = 0, state_hashes = 0;
  std::size_t skipped = 0;         // rows after ticks that were not recorded, up to the next state
  std::size_t damaged_states = 0;  // from which it would have gone on there
};

/// Runs the ticks of a recording again, those after row `first` or all, and compares every result
/// and every state hash bit for bit. What was not recorded is skipped: it goes on from the next
/// recorded state. Throws std::runtime_error that names the first tick and quantity in which they
/// differ, and another build where the recording is of one.
Verified verify_recording(RecordedRun& run, std::size_t first_row);

}  // namespace sulcus
