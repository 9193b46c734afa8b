#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "app/session/feed.hpp"
#include "app/session/frame_history.hpp"
#include "app/session/live_heat.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/scene/scene.hpp"
#include "engine/surface/drawn_surface.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// A run as it is drawn while it runs: takes what is in its feed, and brings a drawing (a Renderer,
/// a GlScene) up to it. Of the thread that consumes the feed.
class LiveFilm {
 public:
  /// Of loose pieces, those whose news have come, or all of the tick that is drawn, waiting for
  /// their news: the picture does not depend on who was faster.
  enum class Pieces : std::uint8_t { kThatAreThere, kAll };

  /// `start`, `earlier`: as FrameHistory has them. The feed outlives it.
  LiveFilm(Feed& feed, const Scene& scene, const VoxelModel& start,
           const EarlierRun* earlier = nullptr)
      : feed_(feed),
        history_(scene, start, earlier),
        dt_s_(1.0 / scene.haptics.rate_hz),
        removed_(1 + scene.bodies.size()),
        lowered_(removed_.size()) {}

  /// Before the first tick is taken: shows how warm the pulp becomes. Arguments as LiveHeat's.
  void show_heat(const Scene& scene, const VoxelModel& start, std::uint64_t first_tick) {
    heat_.emplace(scene, start, first_tick);
  }

  /// The next tick, where one has come.
  std::optional<TickReport> take() {
    TickReport report;
    if (!feed_.reports.try_dequeue(report)) return {};
    last_edits_.clear();
    for (Edit edit; edits_taken_ < report.all_edits_end() && feed_.edits.try_dequeue(edit);) {
      if (edit.is_gone()) {
        removed_[edit.body].push_back(edit.voxel);
      } else {
        lowered_[edit.body].push_back({edit.voxel, edit.level});
      }
      history_.add(edit);
      if (heat_) heat_->add(edit);
      last_edits_.push_back(edit);
      ++edits_taken_;
    }
    history_.add(report);
    if (heat_) heat_->add(report);
    return report;
  }
  bool empty() const { return history_.empty(); }
  /// Of the tick that was taken last.
  std::span<const Edit> last_edits() const { return last_edits_; }

  /// What a picture before the first tick shows: where the tool is, and what came before.
  FrameState before_the_first(std::uint64_t first_tick, const Pose& tool) const {
    FrameState state = history_.state();
    state.tick = first_tick;
    state.time_s = static_cast<double>(first_tick) * dt_s_;
    state.world_from_tool = tool;
    return state;
  }

  /// Brings the drawing to the last tick that was taken.
  template <class Drawing>
  FrameState bring(Drawing& drawing, Pieces pieces) {
    FrameState state = history_.state();
    if (heat_) {
      for (OutcomeLine& line : heat_->lines()) state.outcome.push_back(std::move(line));
    }
    for (std::size_t body = 0; body < lowered_.size(); ++body) {
      if (!lowered_[body].empty()) drawing.set_levels(body, lowered_[body]);
      lowered_[body].clear();
    }
    if (feed_.pieces) bring_pieces(drawing, *feed_.pieces, state.tick, pieces);
    state.pieces = piece_poses_;
    for (std::size_t body = 0; body < removed_.size(); ++body) {
      drawing.remove(body, removed_[body]);
      removed_[body].clear();
    }
    return state;
  }

 private:
  template <class Drawing>
  void bring_pieces(Drawing& drawing, PieceFeed& feed, std::uint64_t tick, Pieces pieces) {
    while (pieces == Pieces::kAll && feed.ticks_done <= tick) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    PieceNews news;
    while (ahead_ || feed.news.try_dequeue(news)) {
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
  FrameHistory history_;
  double dt_s_;
  std::optional<LiveHeat> heat_;
  // By body, since the last picture.
  std::vector<std::vector<std::uint32_t>> removed_;
  std::vector<std::vector<VoxelLevel>> lowered_;
  std::uint64_t edits_taken_ = 0;
  std::vector<Edit> last_edits_;
  std::vector<Pose> piece_poses_;
  std::optional<PieceNews> ahead_;  // of a later tick than is drawn
};

}  // namespace sulcus
