#include "app/session/report_thread.hpp"

#include <chrono>
#include <utility>

#include "engine/core/realtime.hpp"

namespace sulcus {

ReportThread::ReportThread(Feed& feed, std::vector<RunMarks> marks)
    : feed_(feed), marks_(std::move(marks)) {
  thread_ = std::thread([this] {
    try {
      run();
    } catch (...) {
      failure_ = std::current_exception();
      feed_.gone = true;
    }
  });
}

ReportThread::~ReportThread() {
  if (!thread_.joinable()) return;
  feed_.ended = true;
  thread_.join();
}

void ReportThread::finish() {
  thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}

void ReportThread::run() {
  leave_realtime_core();
  // `ended` is read before draining: what was pushed before it was set is still drained.
  for (bool ended = false; !ended;) {
    ended = feed_.ended.load();
    drain();
    if (!ended) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void ReportThread::drain() {
  for (TickReport report; feed_.reports.try_dequeue(report);) {
    statistics_.add(report);
    for (RunMarks& marks : marks_) marks.measures.add(report.record, nullptr);
  }
  const std::uint64_t begin = steady_ns();
  for (Edit edit; feed_.edits.try_dequeue(edit);) {
    for (RunMarks& marks : marks_) marks.preparation.add(edit);
  }
  if (!marks_.empty()) marks_seconds_ += 1e-9 * static_cast<double>(steady_ns() - begin);
}

}  // namespace sulcus
