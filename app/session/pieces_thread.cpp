#include "app/session/pieces_thread.hpp"

#include <algorithm>
#include <chrono>

#include "engine/core/realtime.hpp"

namespace sulcus {

namespace {

constexpr std::uint64_t kPublishEvery = 10;  // ticks between the poses of a piece that moves

/// Whether a voxel is there is all that is asked of them.
std::vector<VoxelModel> without_fills(std::vector<VoxelModel> bodies) {
  for (VoxelModel& body : bodies) body.fills.reset();
  return bodies;
}

}  // namespace

PiecesThread::PiecesThread(Feed& feed, std::vector<PieceFeed*> followers,
                           const Simulation& simulation)
    : feed_(feed),
      followers_(std::move(followers)),
      scene_(simulation.scene()),
      bodies_(without_fills(simulation.other_bodies())),
      levels_(simulation.workpiece().model()),
      finder_(simulation.workpiece().model()),
      world_(finder_.model().grid, *scene_.loose_pieces, still_bodies()),
      thread_(feed) {
  thread_.start(
      [this] {
        leave_realtime_core();
        drain_until_ended(feed_, std::chrono::microseconds(200), [this] { drain(); });
        end();
      },
      [this] { end(); });
}

bool PiecesThread::next_answer(LooseAnswer& answer, bool wait) {
  while (!answers_.try_dequeue(answer)) {
    if (!wait || feed_.closed) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(20));
  }
  return true;
}

void PiecesThread::drain() {
  for (TickReport report; feed_.reports.try_dequeue(report);) {
    const std::uint64_t begin = thread_cpu_ns();
    edits_.clear();
    for (Edit edit; edits_taken_ < report.all_edits_end() && feed_.edits.try_dequeue(edit);) {
      edits_.push_back(edit);
      ++edits_taken_;
    }
    add_tick(report, edits_);
    seconds_ += 1e-9 * static_cast<double>(thread_cpu_ns() - begin);
  }
}

void PiecesThread::end() {
  memory_bytes_ = finder_.memory_bytes() + world_.memory_bytes() + levels_.memory_bytes();
  for (const VoxelModel& body : bodies_) memory_bytes_ += body.leaves.bytes();
  for (PieceFeed* follower : followers_) follower->ticks_done = PieceFeed::kAllTicks;
}

void PiecesThread::add_tick(const TickReport& report, std::span<const Edit> edits) {
  const std::uint64_t tick = report.record.tick;
  for (const Edit& edit : edits) {
    if (edit.cause == EditCause::kLoose) {
      note_loose(edit);
    } else if (edit.body == 0) {
      (void)levels_.before(edit);
    }
  }
  if (std::optional<LooseAnswer> answer = finder_.add_tick(tick, edits)) {
    auto first = answer->voxels.begin();
    for (const std::size_t end : answer->ends) {
      const auto last = answer->voxels.begin() + static_cast<std::ptrdiff_t>(end);
      leaving_end_ += static_cast<std::uint64_t>(last - first);
      leaving_.push_back({{first, last}, 0, leaving_end_, {}, 0, 0});
      first = last;
    }
    answers_.enqueue(std::move(*answer));
  }
  for (; !leaving_.empty() && leaving_.front().end <= report.loose_left; leaving_.pop_front()) {
    free_piece(leaving_.front(), tick);
  }
  if (!edits.empty()) apply(edits);
  world_.step(1.0 / scene_.haptics.rate_hz, finder_.model());
  if (tick % kPublishEvery == 0) publish_poses(tick);
  for (PieceFeed* follower : followers_) follower->ticks_done = tick + 1;
}

std::vector<DebrisWorld::StillBody> PiecesThread::still_bodies() const {
  std::vector<DebrisWorld::StillBody> still;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    still.push_back({&bodies_[i], scene_.bodies[i].world_from_grid});
  }
  return still;
}

/// What was cut may have held a piece; a voxel that is still there holds on.
void PiecesThread::apply(std::span<const Edit> edits) {
  Eigen::AlignedBox3d cut;
  double edge_m = finder_.model().grid.voxel_m;
  for (const Edit& edit : edits) {
    if (!edit.is_gone()) continue;
    if (edit.body == 0) {
      const VoxelGrid& grid = finder_.model().grid;
      cut.extend(grid.centre_world(grid.cell_of_linear(edit.voxel)));
      continue;
    }
    VoxelModel& body = bodies_[edit.body - 1u];
    const Cell cell = body.grid.cell_of_linear(edit.voxel);
    body.set(cell, false);
    edge_m = std::max(edge_m, body.grid.voxel_m);
    cut.extend(scene_.bodies[edit.body - 1u].world_from_grid.point(body.grid.centre_world(cell)));
  }
  if (world_.size() > 0 && !cut.isEmpty()) world_.wake(cut, edge_m);
}

void PiecesThread::note_loose(const Edit& edit) {
  const std::uint64_t number = loose_edits_++;
  const FillLevel level = levels_.before(edit);
  // They come in the order of the pieces; those that were cut meanwhile do not come.
  for (Leaving& piece : leaving_) {
    while (piece.next < piece.voxels.size()) {
      if (piece.voxels[piece.next++] != edit.voxel) continue;
      if (piece.gone.empty()) piece.first_loose_edit = number;
      piece.gone.push_back(edit.voxel);
      piece.levels += level;
      return;
    }
  }
}

void PiecesThread::free_piece(const Leaving& piece, std::uint64_t tick) {
  const double volume_m3 =
      static_cast<double>(piece.levels) / kFullLevel * finder_.model().grid.voxel_volume_m3();
  if (piece.gone.empty() || volume_m3 < scene_.loose_pieces->smallest_m3) return;
  PieceNews news;
  news.tick = tick;
  news.piece = static_cast<std::uint32_t>(world_.add(piece.gone));
  news.voxels = std::make_shared<std::vector<std::uint32_t>>(piece.gone);
  news.first_loose_edit = piece.first_loose_edit;
  published_at_rest_.push_back(false);
  publish(news);
}

void PiecesThread::publish(const PieceNews& news) {
  for (PieceFeed* follower : followers_) follower->news.enqueue(news);
}

void PiecesThread::publish_poses(std::uint64_t tick) {
  for (std::uint32_t piece = 0; piece < published_at_rest_.size(); ++piece) {
    const bool at_rest = world_.at_rest(piece);
    if (at_rest && published_at_rest_[piece]) continue;
    published_at_rest_[piece] = at_rest;
    publish({tick, piece, world_.pose(piece), nullptr, 0});
  }
}

}  // namespace sulcus
