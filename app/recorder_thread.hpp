#pragma once

#include <exception>
#include <optional>
#include <thread>

#include "app/feed.hpp"
#include "app/piece_feed.hpp"
#include "app/statistics.hpp"
#include "engine/recording/recording_writer.hpp"

namespace sulcus {

/// Takes the reports off the haptic thread's hands: counts them for the summary and, where a writer
/// is given, records them, flushed every 50 ms. A disk that fails stops the recording, not the run;
/// `finish` then throws what it said.
class RecorderThread {
 public:
  /// `pieces` is null where none may come loose.
  RecorderThread(Feed& feed, PieceFeed* pieces, std::optional<RecordingWriter> writer,
                 std::size_t expected_ticks);
  ~RecorderThread();
  RecorderThread(const RecorderThread&) = delete;
  RecorderThread& operator=(const RecorderThread&) = delete;

  /// After `feed.ended`: waits for the rest to be on disk. To be called before the statistics.
  void finish();
  const RunStatistics& statistics() const { return statistics_; }

 private:
  void run();
  void drain();
  void drain_pieces();

  Feed& feed_;
  PieceFeed* pieces_;
  std::optional<RecordingWriter> writer_;
  bool cuts_;  // it wants what was cut
  RunStatistics statistics_;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sulcus
