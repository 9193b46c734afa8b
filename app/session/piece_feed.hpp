#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "app/session/queue.hpp"
#include "engine/core/pose.hpp"

namespace sulcus {

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

/// From the thread that moves the pieces to one consumer: single producer, single consumer.
struct PieceFeed {
  Queue<PieceNews> news;
  std::atomic<std::uint64_t> ticks_done{0};  // set after the news of the tick before it
};

}  // namespace sulcus
