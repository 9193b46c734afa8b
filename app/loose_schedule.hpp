#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "engine/volume/edit.hpp"
#include "engine/volume/loose_pieces.hpp"
#include "haptics/tick.hpp"

namespace sulcus {

// Pieces cut loose are looked for beside the haptic thread. Every 25 ticks, after tick 24, 49 and
// so on, it is asked what has come loose, and the answer counts from 50 ticks later on: in a fixed
// order by tick, so that a run does not depend on how fast the search is. A run at real pace whose
// answer is late takes it in the first tick that finds it there, and records which. The voxels then
// leave the workpiece 8,192 a tick at most, so that no piece, however large, costs a tick more.
inline constexpr std::uint64_t kAskEvery = 25, kAnswerAfter = 50;     // ticks
inline constexpr std::size_t kLeavePerTick = TickScratch::kMaxLoose;  // voxels

/// Whether it is asked after a tick.
constexpr bool asks_after(std::uint64_t tick) { return (tick + 1) % kAskEvery == 0; }

/// What had come loose after a tick.
struct LooseAnswer {
  std::uint64_t asked = 0;  // the tick
  std::vector<LoosePiece> pieces;
};

/// Searches a copy of the workpiece. Free of threads: one at a time uses it.
class LooseFinder {
 public:
  explicit LooseFinder(VoxelModel start) : pieces_(std::move(start)) {}

  /// The edits of a tick, each once, in their order. The answer where it is asked after the tick.
  std::optional<LooseAnswer> add_tick(std::uint64_t tick, std::span<const Edit> edits);
  /// What stays.
  const VoxelModel& model() const { return pieces_.model(); }
  std::size_t memory_bytes() const { return pieces_.memory_bytes(); }

 private:
  LoosePieces pieces_;
  std::vector<std::uint32_t> removed_;  // of a tick
};

/// An answer that was late, as a recording holds it.
struct LateAnswer {
  std::uint64_t asked = 0, taken = 0;  // ticks
};

/// Which voxels leave the workpiece in which tick. `Take` gives the next answer, in their order, or
/// null where it is not there yet and the tick does not wait.
class LooseSchedule {
 public:
  /// `late`: of the recording that is played back.
  explicit LooseSchedule(std::span<const LateAnswer> late = {});

  /// Once for every tick, before it. Valid until the next call.
  template <class Take>
  std::span<const std::uint32_t> before_tick(std::uint64_t tick, const Take& take) {
    late_now_.clear();
    while (tick >= due_) {
      const LooseAnswer* answer = take();
      if (!answer) break;
      add(*answer, tick);
    }
    return next_voxels();
  }

  /// The answers that this tick took later than they were due.
  std::span<const LateAnswer> late() const { return late_now_; }
  /// Voxels that have left so far.
  std::uint64_t left() const { return left_; }

 private:
  void add(const LooseAnswer& answer, std::uint64_t tick);
  std::span<const std::uint32_t> next_voxels();
  void find_due();

  std::map<std::uint64_t, std::uint64_t> late_;    // of the recording: taken by asked
  std::uint64_t asked_ = kAskEvery - 1, due_ = 0;  // of the next answer
  std::vector<LateAnswer> late_now_;
  std::vector<std::uint32_t> leaving_;
  std::size_t next_ = 0;
  std::uint64_t left_ = 0;
};

}  // namespace sulcus
