#pragma once

#include <atomic>
#include <deque>
#include <exception>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "app/session/feed.hpp"
#include "app/session/loose_schedule.hpp"
#include "app/session/piece_feed.hpp"
#include "engine/bodies/debris_world.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

// Threads and properties
//
//                  edits, reports                news of pieces
//   haptic thread ---------------> PiecesThread ----------------> recorder, renderer
//        ^                              |
//        +------------------------------+
//             what has come loose
//
// - Answers are a function of the edits before them, poses of edits and ticks: fast or slow,
//   a run gives the same. Nothing here is read by a tick but which voxels leave.
// - The haptic thread waits for an answer only where it runs as fast as it can.

/// Looks for pieces that were cut loose, beside the haptic thread, and moves them until they rest.
class PiecesThread {
 public:
  /// `start`, `bodies`: the workpiece and the others before the first tick, of which it takes
  /// copies. Feeds and scene outlive it.
  PiecesThread(Feed& feed, std::vector<PieceFeed*> consumers, const Scene& scene, VoxelModel start,
               std::vector<VoxelModel> bodies);
  ~PiecesThread();
  PiecesThread(const PiecesThread&) = delete;
  PiecesThread& operator=(const PiecesThread&) = delete;

  /// From the haptic thread: the next answer; false where it is not there yet, with `wait` only
  /// where the search has failed.
  bool next_answer(LooseAnswer& answer, bool wait);

  /// After `feed.ended`: waits for the end; throws what went wrong.
  void finish();
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
    std::uint64_t first_loose_edit = 0;  // number of its first among the edits of loose voxels
  };

  void run();
  void add_tick(const TickReport& report, std::span<const Edit> edits);
  std::vector<DebrisWorld::StillBody> still_bodies() const;
  void note_loose(std::uint32_t voxel);
  void apply(std::span<const Edit> edits);
  void free_piece(const Leaving& piece, std::uint64_t tick);
  void tell(const PieceNews& news);
  void tell_poses(std::uint64_t tick);

  Feed& feed_;
  std::vector<PieceFeed*> consumers_;
  const Scene& scene_;
  std::vector<VoxelModel> bodies_;  // besides the workpiece, as they are now
  LooseFinder finder_;
  DebrisWorld world_;
  Queue<LooseAnswer> answers_;
  std::deque<Leaving> leaving_;
  std::uint64_t leaving_end_ = 0, loose_edits_ = 0;
  std::vector<bool> told_at_rest_;
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;
  std::size_t memory_bytes_ = 0;
  double seconds_ = 0.0;
  std::thread thread_;
};

}  // namespace sulcus
