#include "app/session/pieces_thread.hpp"

#include <algorithm>
#include <chrono>

#include "engine/core/realtime.hpp"

namespace sulcus {

namespace {

constexpr std::uint64_t kTellEvery = 10;  // ticks between the poses of a piece that moves

}  // namespace

PiecesThread::PiecesThread(Feed& feed, std::vector<PieceFeed*> consumers, const Scene& scene,
                           VoxelModel start, std::vector<VoxelModel> bodies)
    : feed_(feed),
      consumers_(std::move(consumers)),
      scene_(scene),
      bodies_(std::move(bodies)),
      finder_(std::move(start)),
      world_(finder_.model().grid, *scene.loose_pieces, still_bodies()) {
  thread_ = std::thread([this] {
    try {
      run();
    } catch (...) {
      failure_ = std::current_exception();
      feed_.gone = true;
      failed_ = true;
      for (PieceFeed* consumer : consumers_) consumer->ticks_done = ~std::uint64_t{0};
    }
  });
}

PiecesThread::~PiecesThread() {
  if (thread_.joinable()) {
    feed_.ended = true;
    thread_.join();
  }
}

void PiecesThread::finish() {
  thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}

bool PiecesThread::next_answer(LooseAnswer& answer, bool wait) {
  while (!answers_.try_dequeue(answer)) {
    if (!wait || failed_) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(20));
  }
  return true;
}

void PiecesThread::run() {
  leave_realtime_core();
  std::vector<Edit> edits;
  std::uint64_t edits_taken = 0;
  for (bool ended = false; !ended;) {
    ended = feed_.ended.load();
    TickReport report;
    while (feed_.reports.try_dequeue(report)) {
      const std::uint64_t begin = thread_cpu_ns();
      edits.clear();
      for (Edit edit; edits_taken < report.record.edits_end && feed_.edits.try_dequeue(edit);) {
        edits.push_back(edit);
        ++edits_taken;
      }
      add_tick(report, edits);
      seconds_ += 1e-9 * static_cast<double>(thread_cpu_ns() - begin);
    }
    if (!ended) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  memory_bytes_ = finder_.memory_bytes() + world_.memory_bytes();
  for (const VoxelModel& body : bodies_) memory_bytes_ += body.leaves.capacity() * sizeof(LeafBits);
  for (PieceFeed* consumer : consumers_) consumer->ticks_done = ~std::uint64_t{0};
}

void PiecesThread::add_tick(const TickReport& report, std::span<const Edit> edits) {
  const std::uint64_t tick = report.record.tick;
  for (const Edit& edit : edits) {
    if (edit.cause == EditCause::kLoose) note_loose(edit.voxel);
  }
  if (std::optional<LooseAnswer> answer = finder_.add_tick(tick, edits)) {
    auto first = answer->voxels.begin();
    for (const std::size_t end : answer->ends) {
      const auto last = answer->voxels.begin() + static_cast<std::ptrdiff_t>(end);
      leaving_end_ += static_cast<std::uint64_t>(last - first);
      leaving_.push_back({{first, last}, 0, leaving_end_, {}, 0});
      first = last;
    }
    answers_.enqueue(std::move(*answer));
  }
  for (; !leaving_.empty() && leaving_.front().end <= report.loose_left; leaving_.pop_front()) {
    free_piece(leaving_.front(), tick);
  }
  if (!edits.empty()) apply(edits);
  world_.step(1.0 / scene_.haptics.rate_hz, finder_.model());
  if (tick % kTellEvery == 0) tell_poses(tick);
  for (PieceFeed* consumer : consumers_) consumer->ticks_done = tick + 1;
}

std::vector<DebrisWorld::StillBody> PiecesThread::still_bodies() const {
  std::vector<DebrisWorld::StillBody> still;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    still.push_back({&bodies_[i], scene_.bodies[i].world_from_grid});
  }
  return still;
}

/// What was cut may have held a piece.
void PiecesThread::apply(std::span<const Edit> edits) {
  Eigen::AlignedBox3d cut;
  double edge_m = finder_.model().grid.voxel_m;
  for (const Edit& edit : edits) {
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
  if (world_.size() > 0) world_.wake(cut, edge_m);
}

void PiecesThread::note_loose(std::uint32_t voxel) {
  const std::uint64_t edit = loose_edits_++;
  // They come in the order of the pieces; those that were cut meanwhile do not come.
  for (Leaving& piece : leaving_) {
    while (piece.next < piece.voxels.size()) {
      if (piece.voxels[piece.next++] != voxel) continue;
      if (piece.gone.empty()) piece.first_loose_edit = edit;
      piece.gone.push_back(voxel);
      return;
    }
  }
}

void PiecesThread::free_piece(const Leaving& piece, std::uint64_t tick) {
  const double volume_m3 =
      static_cast<double>(piece.gone.size()) * finder_.model().grid.voxel_volume_m3();
  if (piece.gone.empty() || volume_m3 < scene_.loose_pieces->smallest_m3) return;
  PieceNews news;
  news.tick = tick;
  news.piece = static_cast<std::uint32_t>(world_.add(piece.gone));
  news.voxels = std::make_shared<std::vector<std::uint32_t>>(piece.gone);
  news.first_loose_edit = piece.first_loose_edit;
  told_at_rest_.push_back(false);
  tell(news);
}

void PiecesThread::tell(const PieceNews& news) {
  for (PieceFeed* consumer : consumers_) consumer->news.enqueue(news);
}

void PiecesThread::tell_poses(std::uint64_t tick) {
  for (std::uint32_t piece = 0; piece < told_at_rest_.size(); ++piece) {
    const bool at_rest = world_.at_rest(piece);
    if (at_rest && told_at_rest_[piece]) continue;
    told_at_rest_[piece] = at_rest;
    tell({tick, piece, world_.pose(piece), nullptr, 0});
  }
}

}  // namespace sulcus
