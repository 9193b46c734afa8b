#pragma once

#include <exception>
#include <optional>
#include <thread>

#include "app/feed.hpp"
#include "app/statistics.hpp"
#include "engine/outcome/preparation_outcome.hpp"

namespace sulcus {

/// Takes the reports off the haptic thread's hands: counts them for the summary and, where an
/// outcome is given, tells it every edit. It touches no file, so that nothing holds it up.
class ReportThread {
 public:
  ReportThread(Feed& feed, std::optional<PreparationOutcome> outcome);
  ~ReportThread();
  ReportThread(const ReportThread&) = delete;
  ReportThread& operator=(const ReportThread&) = delete;

  /// After `feed.ended`: waits for the rest. Throws what ended the thread before it; the feed was
  /// `gone` then.
  void finish();
  // After `finish`.
  const RunStatistics& statistics() const { return statistics_; }
  const std::optional<PreparationOutcome>& outcome() const { return outcome_; }
  double outcome_seconds() const { return outcome_seconds_; }  // spent telling it

 private:
  void run();
  void drain();

  Feed& feed_;
  std::optional<PreparationOutcome> outcome_;
  double outcome_seconds_ = 0.0;
  RunStatistics statistics_;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sulcus
