#include "app/recorder_thread.hpp"

#include <chrono>
#include <vector>

#include "engine/core/realtime.hpp"

namespace sulcus {

RecorderThread::RecorderThread(Feed& feed, std::optional<RecordingWriter> writer,
                               std::optional<PreparationOutcome> outcome,
                               std::size_t expected_ticks)
    : feed_(feed), writer_(std::move(writer)), outcome_(std::move(outcome)) {
  statistics_.reserve(expected_ticks);
  thread_ = std::thread([this] { run(); });
}

RecorderThread::~RecorderThread() {
  if (thread_.joinable()) {
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
  std::vector<Edit> edits;
  std::vector<StateHash> hashes;
  TickReport report;
  while (feed_.reports.try_dequeue(report)) {
    statistics_.add(report);
    rows.push_back(report.record);
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

}  // namespace sulcus
