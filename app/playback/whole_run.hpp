#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/recording/recording_reader.hpp"

namespace sulcus {

/// The ticks of a run from the first tooth on, however often it was gone on from.
struct WholeRun {
  std::vector<TickRecord> rows;
  std::size_t burrs = 1;  // different ones that it was cut with
};

/// The recordings that `reader`'s goes on from are looked for where they were, and beside it. None
/// where one of them is no longer there, or is another now.
std::optional<WholeRun> whole_run(const RecordingReader& reader);

}  // namespace sulcus
