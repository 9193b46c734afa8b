#pragma once

#include <vector>

#include "app/session/feed_thread.hpp"
#include "app/session/run_marks.hpp"
#include "app/session/run_statistics.hpp"

namespace sulcus {

/// Counts the reports for the summary, and gives all ticks and edits to every one of the marks. It
/// touches no file, so that nothing holds it up.
class ReportThread {
 public:
  ReportThread(Feed& feed, std::vector<RunMarks> marks);

  /// As FeedThread.
  void finish() { thread_.finish(); }
  // After `finish`.
  const RunStatistics& statistics() const { return statistics_; }
  const std::vector<RunMarks>& marks() const { return marks_; }
  double marks_seconds() const { return marks_seconds_; }  // spent on them

 private:
  void drain();

  Feed& feed_;
  std::vector<RunMarks> marks_;
  double marks_seconds_ = 0.0;
  RunStatistics statistics_;
  FeedThread thread_;
};

}  // namespace sulcus
