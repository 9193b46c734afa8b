#pragma once

#include <optional>
#include <vector>

#include "app/session/feed_thread.hpp"
#include "app/session/run_marks.hpp"
#include "app/session/run_statistics.hpp"
#include "engine/heat/heat_log.hpp"

namespace sulcus {

/// Counts the reports for the summary, and gives all ticks and edits to every one of the marks, and
/// to the log of what heats the tooth. It touches no file, so that nothing holds it up.
class ReportThread {
 public:
  /// `heat`: of a scene with [heat], empty; none else.
  ReportThread(Feed& feed, std::vector<RunMarks> marks, std::optional<HeatLog> heat);

  /// As FeedThread.
  void finish() { thread_.finish(); }
  // After `finish`.
  const RunStatistics& statistics() const { return statistics_; }
  const std::vector<RunMarks>& marks() const { return marks_; }
  double marks_seconds() const { return marks_seconds_; }  // spent on them
  const std::optional<HeatLog>& heat() const { return heat_; }

 private:
  void drain();

  Feed& feed_;
  std::vector<RunMarks> marks_;
  double marks_seconds_ = 0.0;
  std::optional<HeatLog> heat_;
  RunStatistics statistics_;
  FeedThread thread_;
};

}  // namespace sulcus
