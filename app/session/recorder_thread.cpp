#include "app/session/recorder_thread.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "engine/core/realtime.hpp"

namespace sulcus {

namespace {

/// From flush to flush: a kill costs what has come since the last one began.
constexpr std::chrono::milliseconds kFlushEvery{30};

// Taken at once, at most: what waits longer waits in the queues, and a disk or a processor that was
// busy costs no more memory than they have.
constexpr std::size_t kMostRows = 4096, kMostEdits = 1 << 16;

}  // namespace

RecorderThread::RecorderThread(RecordFeed& feed, PieceFeed* pieces, RecordingWriter writer)
    : feed_(feed), pieces_(pieces), writer_(std::move(writer)) {
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

void RecorderThread::close(std::string_view summary) {
  if (!writer_) return;
  if (!summary.empty()) writer_->append_summary(summary);
  writer_->close();
  writer_.reset();
}

void RecorderThread::run() {
  leave_realtime_core();
  // `ended` is read before draining: what was pushed before it was set is still drained.
  for (bool ended = false; !ended;) {
    ended = feed_.ended.load();
    // The news of the last ticks come when their thread has ended too.
    while (ended && pieces_ && pieces_->ticks_done != ~std::uint64_t{0}) {
      drain_all();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    const auto next = std::chrono::steady_clock::now() + kFlushEvery;
    drain_all();
    if (!ended) std::this_thread::sleep_until(next);
  }
}

void RecorderThread::drain_all() {
  while (drain()) {
  }
}

bool RecorderThread::drain() {
  if (!writer_) return pass_over();
  try {
    return write_down();
  } catch (...) {
    failure_ = std::current_exception();
    feed_.gone = true;
    writer_.reset();
    return true;
  }
}

bool RecorderThread::pass_over() {
  while (feed_.reports.pop() || feed_.edits.pop()) {
  }
  return false;
}

bool RecorderThread::write_down() {
  std::vector<TickRecord> rows;
  std::vector<CuttingRecord> cuts;
  std::vector<PortRecord> port;
  std::vector<Edit> edits;
  for (TickReport report; rows.size() < kMostRows && feed_.reports.try_dequeue(report);) {
    rows.push_back(report.record);
    if (writer_->has_cutting()) cuts.push_back(report.cutting);
    if (writer_->has_port()) port.push_back(report.port);
  }
  for (Edit edit; edits.size() < kMostEdits && feed_.edits.try_dequeue(edit);) {
    edits.push_back(edit);
  }
  writer_->append_edits(edits);
  if (pieces_) drain_pieces();
  if (!cuts.empty()) writer_->append_cutting(cuts);
  if (!port.empty()) writer_->append_port(port);
  writer_->append_ticks(rows);
  if (!rows.empty()) last_tick_ = rows.back().tick;
  drain_states();
  writer_->flush();
  return rows.size() == kMostRows || edits.size() == kMostEdits;
}

/// A hash or a state of a tick whose row has not come yet waits for the next round.
void RecorderThread::drain_states() {
  const auto has_come = [this](std::uint64_t tick) { return last_tick_ && tick <= *last_tick_; };
  while (const StateHash* hash = feed_.hashes.peek()) {
    if (!has_come(hash->tick)) break;
    writer_->append_state_hash(*hash);
    feed_.hashes.pop();
  }
  while (const Keyframe* next = feed_.keyframes.peek()) {
    if (!has_come(next->tick)) break;
    Keyframe keyframe;
    feed_.keyframes.try_dequeue(keyframe);
    writer_->append_keyframe(keyframe.tick, keyframe.state);
    keyframe.state.clear();
    feed_.spare_keyframes.enqueue(std::move(keyframe));
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
