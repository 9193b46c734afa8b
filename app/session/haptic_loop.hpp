#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "app/session/feed.hpp"
#include "app/session/feed_thread.hpp"
#include "app/session/pacer.hpp"
#include "app/session/pieces_thread.hpp"
#include "app/session/session.hpp"
#include "app/session/simulation.hpp"
#include "app/terminal/progress.hpp"
#include "haptics/device/device.hpp"
#include "haptics/loose_schedule.hpp"

namespace sulcus {

/// The haptic thread's end of the recorder's feed. Does nothing without one, or once it is closed.
class RecordProducer {
 public:
  /// `feed` is null where the scene has no [record].
  RecordProducer(const Simulation& simulation, Pace pace, RecordFeed* feed)
      : simulation_(simulation), pace_(pace), feed_(feed) {}

  /// The answers that the next tick takes.
  void push(std::span<const TakenAnswer> taken);
  /// A tick, whose report is marked where rows before it were dropped; with it, where they are due,
  /// a hash and a keyframe of the state.
  void push(TickReport& report, std::span<const Edit> edits);
  /// After the last tick, of which there was one.
  void end();
  std::uint64_t dropped_rows() const { return dropped_rows_; }

 private:
  bool is_open() const { return feed_ && !feed_->closed; }
  void wait_for_room(const TickReport& report);
  void end_gap();
  void push_hash();
  void push_keyframe();

  const Simulation& simulation_;
  Pace pace_;
  RecordFeed* feed_;
  // By the number of the tick after it: the last hash, the last keyframe, the earliest next one.
  std::uint64_t hash_at_ = 0, keyframe_at_ = 0, keyframe_next_ = 0;
  double since_keyframe_us_ = 0.0;  // computed
  std::uint64_t dropped_rows_ = 0;
  bool in_gap_ = false;      // the row before was dropped
  TickReport last_dropped_;  // where it was
};

/// The loop around the tick: what only a thread with a clock knows.
class HapticLoop {
 public:
  /// `pieces` is null without [loose_pieces], `progress` at real pace. All outlive it.
  HapticLoop(Simulation& simulation, Device& device, const SessionOptions& options, Feeds& feeds,
             PiecesThread* pieces, Progress* progress);

  /// Whatever ends the ticks, the device loses its force, and all feeds end after what was pushed.
  void run() noexcept;
  /// Ends the run after the tick in hand. Of any thread.
  void stop() { stop_ = true; }

  // After `run`.
  std::uint64_t missed() const { return pacer_.missed(); }
  std::uint64_t dropped_rows() const { return record_.dropped_rows(); }
  const std::vector<std::string>& refused() const { return refused_; }
  void rethrow() const { failure_.rethrow(); }

 private:
  bool is_stopped() const;
  void run_ticks();
  void wait_out_pause();
  std::span<const std::uint32_t> loose_voxels();
  TickReport step(std::span<const std::uint32_t> loose, float late_us);
  void publish(TickReport& report);

  Simulation& simulation_;
  Device& device_;
  const SessionOptions& options_;
  Feeds& all_feeds_;
  std::vector<Feed*> feeds_;  // but the recorder's
  RecordProducer record_;
  PiecesThread* pieces_;
  LooseSchedule loose_;
  Pacer pacer_;
  std::uint64_t done_ = 0, edits_ = 0, fills_ = 0;
  std::vector<std::string> refused_;
  FirstFailure failure_;
  std::atomic<bool> stop_{false};
  Progress* progress_;
};

}  // namespace sulcus
