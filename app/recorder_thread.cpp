#include "app/recorder_thread.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "engine/core/realtime.hpp"

namespace sulcus {

RecorderThread::RecorderThread(Feed& feed, PieceFeed* pieces, std::optional<RecordingWriter> writer,
                               std::optional<PreparationOutcome> outcome,
                               std::size_t expected_ticks)
    : feed_(feed),
      pieces_(pieces),
      writer_(std::move(writer)),
      cuts_(writer_ && writer_->has_cutting()),
      port_(writer_ && writer_->has_port()),
      outcome_(std::move(outcome)) {
  statistics_.reserve(expected_ticks);
  thread_ = std::thread([this] { run(); });
}

RecorderThread::~RecorderThread() {
  if (thread_.joinable()) {
    if (pieces_) pieces_->ticks_done = ~std::uint64_t{0};  // nobody tells it any more
    feed_.ended = true;
    thread_.join();
  }
}

void RecorderThread::finish() {
  thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}

void RecorderThread::run() {
  leave_realtime_core();
  // `ended` is read before draining: what was pushed before it was set is still drained.
  for (bool ended = false; !ended;) {
    ended = feed_.ended.load();
    // The news of the last ticks come when their thread has ended too.
    while (ended && pieces_ && pieces_->ticks_done != ~std::uint64_t{0}) {
      drain();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    drain();
    if (!ended) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  if (writer_) {
    try {
      writer_->close();
    } catch (...) {
      failure_ = std::current_exception();
    }
  }
}

void RecorderThread::drain() {
  std::vector<TickRecord> rows;
  std::vector<CuttingRecord> cuts;
  std::vector<PortRecord> port;
  std::vector<Edit> edits;
  TickReport report;
  while (feed_.reports.try_dequeue(report)) {
    statistics_.add(report);
    rows.push_back(report.record);
    if (cuts_) cuts.push_back(report.cutting);
    if (port_) port.push_back(report.port);
  }
  for (Edit edit; feed_.edits.try_dequeue(edit);) edits.push_back(edit);
  if (outcome_) {
    const std::uint64_t begin = steady_ns();
    for (const Edit& edit : edits) outcome_->add(edit);
    outcome_seconds_ += 1e-9 * static_cast<double>(steady_ns() - begin);
  }
  if (!writer_) return;
  try {
    writer_->append_edits(edits);
    if (pieces_) drain_pieces();
    if (cuts_) writer_->append_cutting(cuts);
    if (port_) writer_->append_port(port);
    writer_->append_ticks(rows);
    // A hash of a tick whose row has not come yet waits for the next round.
    const StateHash* hash = feed_.hashes.peek();
    for (; hash && !rows.empty() && hash->tick <= rows.back().tick; hash = feed_.hashes.peek()) {
      writer_->append_state_hash(*hash);
      feed_.hashes.pop();
    }
    writer_->flush();
  } catch (...) {
    failure_ = std::current_exception();
    writer_.reset();
  }
}

void RecorderThread::drain_pieces() {
  for (TakenAnswer taken; feed_.taken.try_dequeue(taken);) {
    TakenAnswerRow row{taken.asked, taken.taken, 0};
    seal(row);
    writer_->append_taken_answer(row);
  }
  for (PieceNews news; pieces_->news.try_dequeue(news);) {
    if (news.voxels) {
      PieceRow row{news.piece, news.tick, news.first_loose_edit, news.voxels->size(), 0};
      seal(row);
      writer_->append_piece(row);
      continue;
    }
    PiecePoseRow row;
    row.tick = news.tick;
    row.piece = news.piece;
    std::copy_n(news.world_now_from_start.position.data(), 3, row.position_m);
    const Eigen::Quaterniond& q = news.world_now_from_start.orientation;
    row.orientation[0] = q.w();
    std::copy_n(q.vec().data(), 3, row.orientation + 1);
    seal(row);
    writer_->append_piece_pose(row);
  }
}

}  // namespace sulcus
