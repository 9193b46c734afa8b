#pragma once

#include <exception>
#include <optional>
#include <thread>

#include "app/feed.hpp"
#include "app/piece_feed.hpp"
#include "app/statistics.hpp"
#include "engine/outcome/preparation_outcome.hpp"
#include "engine/recording/recording_writer.hpp"

namespace sulcus {

/// Takes the reports off the haptic thread's hands: counts them for the summary and, where a writer
/// is given, records them, flushed every 50 ms; where an outcome is given, tells it every edit. A
/// disk that fails stops the recording, not the run; `finish` then throws what it said.
class RecorderThread {
 public:
  /// `pieces` is null where none may come loose.
  RecorderThread(Feed& feed, PieceFeed* pieces, std::optional<RecordingWriter> writer,
                 std::optional<PreparationOutcome> outcome, std::size_t expected_ticks);
  ~RecorderThread();
  RecorderThread(const RecorderThread&) = delete;
  RecorderThread& operator=(const RecorderThread&) = delete;

  /// After `feed.ended`: waits for the rest to be on disk. To be called before the statistics.
  void finish();
  const RunStatistics& statistics() const { return statistics_; }
  /// Of all edits, after `finish`.
  const std::optional<PreparationOutcome>& outcome() const { return outcome_; }
  double outcome_seconds() const { return outcome_seconds_; }  // spent telling it

 private:
  void run();
  void drain();
  void drain_pieces();

  Feed& feed_;
  PieceFeed* pieces_;
  std::optional<RecordingWriter> writer_;
  bool cuts_;  // it wants what was cut
  bool port_;  // and what went through the device's port
  std::optional<PreparationOutcome> outcome_;
  double outcome_seconds_ = 0.0;
  RunStatistics statistics_;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sulcus
