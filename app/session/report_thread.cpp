#include "app/session/report_thread.hpp"

#include <chrono>
#include <utility>

#include "engine/core/realtime.hpp"

namespace sulcus {

ReportThread::ReportThread(Feed& feed, std::vector<RunMarks> marks, std::optional<HeatLog> heat)
    : feed_(feed), marks_(std::move(marks)), heat_(std::move(heat)), thread_(feed) {
  thread_.start([this] {
    leave_realtime_core();
    drain_until_ended(feed_, std::chrono::milliseconds(50), [this] { drain(); });
  });
}

void ReportThread::drain() {
  for (TickReport report; feed_.reports.try_dequeue(report);) {
    statistics_.add(report);
    for (RunMarks& marks : marks_) marks.measures.add(report.record, nullptr);
    if (heat_) heat_->add(report.record, report.cutting);
  }
  const std::uint64_t begin = steady_ns();
  for (Edit edit; feed_.edits.try_dequeue(edit);) {
    for (RunMarks& marks : marks_) marks.preparation.add(edit);
    if (heat_) heat_->add(edit);
  }
  if (!marks_.empty()) marks_seconds_ += seconds_since(begin);
}

}  // namespace sulcus
