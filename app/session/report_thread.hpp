#pragma once

#include <exception>
#include <thread>
#include <vector>

#include "app/report/run_marks.hpp"
#include "app/report/statistics.hpp"
#include "app/session/feed.hpp"

namespace sulcus {

/// Takes the reports off the haptic thread's hands: counts them for the summary, and tells every
/// one of the marks it is given all ticks and edits. It touches no file, so that nothing holds it
/// up.
class ReportThread {
 public:
  ReportThread(Feed& feed, std::vector<RunMarks> marks);
  ~ReportThread();
  ReportThread(const ReportThread&) = delete;
  ReportThread& operator=(const ReportThread&) = delete;

  /// After `feed.ended`: waits for the rest. Throws what ended the thread before it; the feed was
  /// `gone` then.
  void finish();
  // After `finish`.
  const RunStatistics& statistics() const { return statistics_; }
  const std::vector<RunMarks>& marks() const { return marks_; }
  double marks_seconds() const { return marks_seconds_; }  // spent telling them

 private:
  void run();
  void drain();

  Feed& feed_;
  std::vector<RunMarks> marks_;
  double marks_seconds_ = 0.0;
  RunStatistics statistics_;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sulcus
