#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "engine/volume/edit.hpp"
#include "engine/volume/loose_pieces.hpp"
#include "haptics/tick_scratch.hpp"

namespace sulcus {

// Pieces cut loose are looked for beside the haptic thread. Every 10 ticks, after tick 9, 19 and so
// on, it is asked what has come loose, and the answer counts from 50 ticks later on: in a fixed
// order by tick, so that a run does not depend on how fast the search is. A run at real pace whose
// answer is late takes it in the first tick that finds it there. Which tick took which answer is
// recorded; a replay does the same. The voxels leave the workpiece leaf by leaf, 4,096 a tick at
// most, so that what a piece costs a tick is bounded.
inline constexpr std::uint64_t kAskEvery = 10, kAnswerAfter = 50;     // ticks
inline constexpr std::size_t kLeavePerTick = TickScratch::kMaxLoose;  // voxels

/// Whether it is asked after a tick.
constexpr bool asks_after(std::uint64_t tick) { return (tick + 1) % kAskEvery == 0; }

/// What had come loose after a tick.
struct LooseAnswer {
  std::uint64_t asked = 0;            // the tick
  std::vector<std::uint32_t> voxels;  // piece after piece, each leaf by leaf
  std::vector<std::size_t> ends;      // of the pieces, in `voxels`
};

/// Searches a copy of the workpiece. Free of threads: one at a time uses it.
class LooseFinder {
 public:
  explicit LooseFinder(VoxelModel start) : pieces_(without_fills(std::move(start))) {}

  /// The edits of a tick, each once, in their order; those of other bodies than the workpiece and
  /// of voxels that are still there are skipped. The answer where it is asked after the tick.
  std::optional<LooseAnswer> add_tick(std::uint64_t tick, std::span<const Edit> edits);
  /// What stays.
  const VoxelModel& model() const { return pieces_.model(); }
  std::size_t memory_bytes() const { return pieces_.memory_bytes(); }

 private:
  static VoxelModel without_fills(VoxelModel model) {
    model.fills.reset();  // whether a voxel is there is all that is asked
    return model;
  }

  LoosePieces pieces_;
  std::vector<std::uint32_t> removed_;  // of a tick
};

/// Which tick took what had come loose after another.
struct TakenAnswer {
  std::uint64_t asked = 0, taken = 0;  // ticks
};

/// Which voxels leave the workpiece in which tick. For one thread.
class LooseSchedule {
 public:
  /// Takes answers when they are due, or as soon as they are there. `first`: tick that comes next,
  /// where a run does not begin with tick 0.
  explicit LooseSchedule(std::uint64_t first = 0)
      : asked_(first + (kAskEvery - 1) - first % kAskEvery) {}
  /// As a recording did; an answer that it did not take is never taken.
  explicit LooseSchedule(std::span<const TakenAnswer> played_back, std::uint64_t first = 0);

  /// Once for every tick, before it: its voxels, valid until the next call. `take` moves the next
  /// answer, in their order, into what it is given; false where it is not there yet.
  template <class Take>
  std::span<const std::uint32_t> before_tick(std::uint64_t tick, const Take& take) {
    taken_now_.clear();
    for (LooseAnswer answer; tick >= due() && take(answer); answer = {}) {
      taken_now_.push_back({answer.asked, tick});
      leaving_.push_back(std::move(answer));
      asked_ += kAskEvery;
    }
    return next_voxels();
  }

  /// The answers that this tick took.
  std::span<const TakenAnswer> taken() const { return taken_now_; }
  /// Voxels that have left so far, or were gone when they should have.
  std::uint64_t left() const { return left_; }

 private:
  std::uint64_t due() const;
  std::span<const std::uint32_t> next_voxels();

  bool plays_back_ = false;
  std::map<std::uint64_t, std::uint64_t> taken_by_asked_;  // of the recording
  std::uint64_t asked_ = kAskEvery - 1;                    // tick of the next answer
  std::vector<TakenAnswer> taken_now_;
  std::deque<LooseAnswer> leaving_;
  std::size_t next_ = 0;  // voxel of the first of them
  std::uint64_t left_ = 0;
};

}  // namespace sulcus
