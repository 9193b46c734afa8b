#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <string_view>
#include <thread>

#include "app/session/feed.hpp"
#include "app/session/piece_feed.hpp"
#include "engine/recording/recording_writer.hpp"

namespace sulcus {

/// Records the run, flushed every 30 ms. A disk that fails stops the recording, not the run;
/// `finish` then throws what it said. One that stalls holds up this thread alone.
class RecorderThread {
 public:
  /// `pieces` is null where none may come loose.
  RecorderThread(RecordFeed& feed, PieceFeed* pieces, RecordingWriter writer);
  ~RecorderThread();
  RecorderThread(const RecorderThread&) = delete;
  RecorderThread& operator=(const RecorderThread&) = delete;

  /// After `feed.ended`: waits for the rest to be on disk.
  void finish();
  /// After `finish`, once: writes summary.json of the run, nothing where that is empty, and closes
  /// the recording. std::runtime_error as RecordingWriter; nothing after a failure.
  void close(std::string_view summary);

 private:
  void run();
  void drain_all();
  /// Whether there may be more.
  bool drain();
  bool write_down();
  bool pass_over();  // once the disk has failed
  void drain_pieces();
  void drain_states();

  RecordFeed& feed_;
  PieceFeed* pieces_;
  std::optional<RecordingWriter> writer_;   // none once the disk has failed
  std::optional<std::uint64_t> last_tick_;  // of the rows that have come
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sulcus
