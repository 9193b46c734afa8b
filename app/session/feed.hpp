#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <readerwriterqueue/readerwriterqueue.h>

#include "engine/core/pose.hpp"
#include "engine/recording/recording_header.hpp"
#include "engine/recording/tick_record.hpp"
#include "engine/volume/edit.hpp"
#include "haptics/loose_schedule.hpp"
#include "haptics/stage_clock.hpp"

namespace sulcus {

// What the threads of a run pass to each other: session.hpp draws who feeds whom.
//
// Properties of a feed
//
// - Lock-free: one producer, one consumer. The producer never waits at real pace.
// - Ordered: a report is pushed after all its edits. Who has popped a report finds its edits there.
// - Lossless: beyond its size a queue takes more memory, outside the tick. Only the recorder's
//   reports are bounded, since a disk may stall for good: at real pace rows are then dropped.
// - Ended by its producer (`ended`, after the last push), closed by its consumer (`closed`).

/// Single producer, single consumer, no lock; takes memory only when it is full.
template <class T>
using Queue = moodycamel::ReaderWriterQueue<T>;

/// What a tick leaves behind besides its edits.
struct TickReport {
  TickRecord record;
  CuttingRecord cutting;  // with [cutting]
  PortRecord port;
  double pedal = 1.0;  // of the tick: share of the burr's speed that is asked for
  std::array<float, kStageCount> stage_us{};
  std::uint64_t loose_left = 0;  // voxels of loose pieces that have left, or were gone: so far
  std::uint64_t fills_end = 0;   // edits up to and with this tick that lowered a level

  /// All edits up to and with this tick.
  std::uint64_t all_edits_end() const { return record.edits_end + fills_end; }
};

/// A piece that was cut loose: that it is one, or how far it has moved.
struct PieceNews {
  std::uint64_t tick = 0;
  std::uint32_t piece = 0;  // numbered from 0 as they come
  Pose world_now_from_start;
  // Of a piece that has just come loose, else null: its voxels, and the number of the first among
  // all edits whose cause is `loose`; they follow one another there.
  std::shared_ptr<const std::vector<std::uint32_t>> voxels;
  std::uint64_t first_loose_edit = 0;
};

/// From the thread that moves the pieces to one consumer.
struct PieceFeed {
  static constexpr std::uint64_t kAllTicks = ~std::uint64_t{0};

  Queue<PieceNews> news;
  std::atomic<std::uint64_t> ticks_done{0};  // set after the news of the tick before it

  bool ended() const { return ticks_done == kAllTicks; }
};

/// From the haptic thread to one consumer.
struct Feed {
  explicit Feed(double rate_hz, double seconds = 4.0)
      : reports(std::max<std::size_t>(1, static_cast<std::size_t>(seconds * rate_hz))),
        edits(std::size_t{1} << 16) {}

  Queue<TickReport> reports;
  Queue<Edit> edits;
  std::atomic<bool> ended{false};   // nothing more is pushed
  std::atomic<bool> closed{false};  // nothing more is taken: the consumer failed, or has enough
  std::optional<PieceFeed> pieces;  // with [loose_pieces], where the consumer shows or keeps them
};

/// A state as it was right after a tick, as save_state writes it.
struct Keyframe {
  std::uint64_t tick = 0;
  std::vector<std::byte> state;
};

/// The recorder's, which alone gets states and their hashes.
struct RecordFeed : Feed {
  /// Room for so many seconds of rows. Room of states that is not used takes no memory; a state
  /// that needs more takes it once.
  RecordFeed(double rate_hz, double seconds) : Feed(rate_hz, seconds) {
    constexpr int kKeyframesOnTheWay = 4;
    for (int spare = 0; spare < kKeyframesOnTheWay; ++spare) {
      Keyframe keyframe;
      keyframe.state.reserve(std::size_t{1} << 20);
      spare_keyframes.enqueue(std::move(keyframe));
    }
  }

  Queue<StateHash> hashes;
  Queue<TakenAnswer> taken;
  Queue<Keyframe> keyframes;
  Queue<Keyframe> spare_keyframes;  // the other way: their memory, to be used again; none: wait
};

/// The feeds of a run, one for each consumer that it has.
struct Feeds {
  explicit Feeds(double rate_hz) : reports(rate_hz) {}

  Feed reports;
  std::optional<RecordFeed> record;  // with [record]
  std::optional<Feed> frames;        // with [render], where it is to be drawn
  std::optional<Feed> watch;         // of a window
  std::optional<Feed> pieces;        // with [loose_pieces]
  std::optional<Feed> stream;        // with [stream], where it is to be sent

  /// All but the recorder's.
  std::vector<Feed*> without_record() {
    std::vector<Feed*> feeds{&reports};
    for (auto* feed : {&frames, &watch, &pieces, &stream}) {
      if (*feed) feeds.push_back(&**feed);
    }
    return feeds;
  }
  /// Of those who follow the pieces.
  std::vector<PieceFeed*> of_pieces() {
    std::vector<Feed*> feeds = without_record();
    if (record) feeds.push_back(&*record);
    std::vector<PieceFeed*> followers;
    for (Feed* feed : feeds) {
      if (feed->pieces) followers.push_back(&*feed->pieces);
    }
    return followers;
  }
};

}  // namespace sulcus
