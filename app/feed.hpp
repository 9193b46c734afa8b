#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "app/loose_schedule.hpp"
#include "app/queue.hpp"
#include "engine/recording/recording_header.hpp"
#include "engine/recording/tick_record.hpp"
#include "engine/volume/edit.hpp"
#include "haptics/stage_clock.hpp"

namespace sulcus {

/// What a tick leaves behind besides its edits.
struct TickReport {
  TickRecord record;
  CuttingRecord cutting;  // with [cutting]
  PortRecord port;
  std::array<float, kStageCount> stage_us{};
  std::uint64_t loose_left = 0;  // voxels of loose pieces that have left, or were gone: so far
};

// Threads and properties
//
//   haptic thread ---- edits, then the report of their tick ---->  one consumer each:
//                      (one Feed per consumer)                     recorder, renderer, pieces
//
// - Single producer, single consumer, no lock. The producer never waits.
// - A report is pushed after all its edits: who has popped a report finds its edits there.
// - Sized for ten seconds; beyond that a queue takes more memory, outside the tick, rather than
//   lose anything.
struct Feed {
  explicit Feed(double rate_hz)
      : reports(static_cast<std::size_t>(10 * rate_hz)), edits(std::size_t{1} << 16) {}

  Queue<TickReport> reports;
  Queue<Edit> edits;
  // The recorder's only, and only of a run that is recorded.
  Queue<StateHash> hashes;
  Queue<TakenAnswer> taken;
  std::atomic<bool> ended{false};  // set after the last push
};

}  // namespace sulcus
