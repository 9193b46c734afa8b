#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "app/session/loose_schedule.hpp"
#include "app/session/queue.hpp"
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
//                      (one Feed per consumer)                     reports, recorder, renderer,
//                                                                  pieces
//
// - Single producer, single consumer, no lock. The producer never waits at real pace.
// - A report is pushed after all its edits: who has popped a report finds its edits there.
// - Beyond its size a queue takes more memory, outside the tick, rather than lose anything. Only
//   the recorder's reports, whose disk may stall for good, are no more than it has room for.
struct Feed {
  explicit Feed(double rate_hz, double seconds = 10.0)
      : reports(std::max<std::size_t>(1, static_cast<std::size_t>(seconds * rate_hz))),
        edits(std::size_t{1} << 16) {}

  Queue<TickReport> reports;
  Queue<Edit> edits;
  std::atomic<bool> ended{false};  // set after the last push
  std::atomic<bool> gone{false};   // set by a consumer that has failed: it is told nothing more
};

/// A state as it was right after a tick, as save_state writes it.
struct Keyframe {
  std::uint64_t tick = 0;
  std::vector<std::byte> state;
};

/// The recorder's: what no one else is told.
struct RecordFeed : Feed {
  using Feed::Feed;

  Queue<StateHash> hashes;
  Queue<TakenAnswer> taken;
  Queue<Keyframe> keyframes;
  Queue<Keyframe> spare_keyframes;  // the other way: their memory, to be used again; none: wait
};

}  // namespace sulcus
