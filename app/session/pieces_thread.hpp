#pragma once

#include <atomic>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "app/session/feed_thread.hpp"
#include "app/session/simulation.hpp"
#include "engine/bodies/debris_world.hpp"
#include "engine/volume/level_changes.hpp"
#include "haptics/loose_schedule.hpp"

namespace sulcus {

/// Looks for pieces that were cut loose, beside the haptic thread, and moves them until they rest.
/// Answers are a function of the edits before them, poses of edits and ticks: fast or slow, a run
/// gives the same. Nothing here is read by a tick but which voxels leave.
class PiecesThread {
 public:
  /// Copies the bodies as they are before the first tick. The feeds and the simulation's scene
  /// outlive it.
  PiecesThread(Feed& feed, std::vector<PieceFeed*> followers, const Simulation& simulation);

  /// From the haptic thread: the next answer; false where it is not there yet, with `wait` only
  /// where the search has failed.
  bool next_answer(LooseAnswer& answer, bool wait);

  /// As FeedThread.
  void finish() { thread_.finish(); }
  // After `finish`.
  std::size_t pieces() const { return world_.size(); }
  double seconds() const { return seconds_; }
  std::size_t memory_bytes() const { return memory_bytes_; }

 private:
  /// A piece on its way out of the workpiece.
  struct Leaving {
    std::vector<std::uint32_t> voxels;
    std::size_t next = 0;                // that may come
    std::uint64_t end = 0;               // voxels that have left once it has
    std::vector<std::uint32_t> gone;     // its voxels that were not cut before
    std::uint64_t levels = 0;            // that they were filled up to, their sum
    std::uint64_t first_loose_edit = 0;  // number of its first among the edits of loose voxels
  };

  void drain();
  void end();
  void add_tick(const TickReport& report, std::span<const Edit> edits);
  std::vector<DebrisWorld::StillBody> still_bodies() const;
  void note_loose(const Edit& edit);
  void apply(std::span<const Edit> edits);
  void free_piece(const Leaving& piece, std::uint64_t tick);
  void publish(const PieceNews& news);
  void publish_poses(std::uint64_t tick);

  Feed& feed_;
  std::vector<PieceFeed*> followers_;
  const Scene& scene_;
  std::vector<VoxelModel> bodies_;  // besides the workpiece, as they are now, without fractions
  LevelChanges levels_;             // of the workpiece
  LooseFinder finder_;
  DebrisWorld world_;
  Queue<LooseAnswer> answers_;
  std::deque<Leaving> leaving_;
  std::uint64_t leaving_end_ = 0, loose_edits_ = 0, edits_taken_ = 0;
  std::vector<Edit> edits_;              // of a tick
  std::vector<bool> published_at_rest_;  // of each piece, the last time
  std::size_t memory_bytes_ = 0;
  double seconds_ = 0.0;
  FeedThread thread_;
};

}  // namespace sulcus
