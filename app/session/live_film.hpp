#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "app/session/feed.hpp"
#include "app/session/frame_history.hpp"
#include "app/session/piece_feed.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// A run as it is drawn while it runs: takes what its feed tells, and brings a drawing (a Renderer,
/// a GlScene) up to it. Of the thread that consumes the feed.
class LiveFilm {
 public:
  /// `pieces` is null where none may come loose. `start`, `earlier`: as FrameHistory has them.
  /// The feeds outlive it.
  LiveFilm(Feed& feed, PieceFeed* pieces, const Scene& scene, const VoxelModel& start,
           const EarlierRun* earlier = nullptr)
      : feed_(feed),
        pieces_(pieces),
        history_(scene, start, earlier),
        removed_(1 + scene.bodies.size()) {}

  /// The next tick, where one has come.
  std::optional<TickReport> take() {
    TickReport report;
    if (!feed_.reports.try_dequeue(report)) return {};
    for (Edit edit; edits_taken_ < report.record.edits_end && feed_.edits.try_dequeue(edit);) {
      removed_[edit.body].push_back(edit.voxel);
      history_.add(edit);
      ++edits_taken_;
    }
    history_.add(report);
    return report;
  }
  bool empty() const { return history_.empty(); }

  /// Brings the drawing to the last tick that was taken. `wait`: for the news of its pieces, so
  /// that the picture does not depend on who was faster.
  template <class Drawing>
  FrameState bring(Drawing& drawing, bool wait) {
    FrameState state = history_.state();
    if (pieces_) bring_pieces(drawing, state.tick, wait);
    state.pieces = piece_poses_;
    for (std::size_t body = 0; body < removed_.size(); ++body) {
      drawing.remove(body, removed_[body]);
      removed_[body].clear();
    }
    return state;
  }

 private:
  template <class Drawing>
  void bring_pieces(Drawing& drawing, std::uint64_t tick, bool wait) {
    while (wait && pieces_->ticks_done <= tick) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    PieceNews news;
    while (ahead_ || pieces_->news.try_dequeue(news)) {
      if (ahead_) news = std::move(*std::exchange(ahead_, std::nullopt));
      if (news.tick > tick) {
        ahead_ = std::move(news);
        break;
      }
      if (news.voxels) {
        drawing.add_piece(*news.voxels);
        piece_poses_.emplace_back();
      } else {
        piece_poses_[news.piece] = news.world_now_from_start;
      }
    }
  }

  Feed& feed_;
  PieceFeed* pieces_;
  FrameHistory history_;
  std::vector<std::vector<std::uint32_t>> removed_;  // by body, since the last picture
  std::uint64_t edits_taken_ = 0;
  std::vector<Pose> piece_poses_;
  std::optional<PieceNews> ahead_;  // of a later tick than is drawn
};

}  // namespace sulcus
