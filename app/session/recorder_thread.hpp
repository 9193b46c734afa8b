#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "app/session/feed_thread.hpp"
#include "app/session/session.hpp"
#include "app/session/simulation.hpp"
#include "engine/recording/recording_writer.hpp"

namespace sulcus {

/// A recording in `file` with what is known before the first tick; `pedal`: there may be one.
/// Errors as RecordingWriter.
RecordingWriter begin_recording(const Simulation& simulation, const SessionOptions& options,
                                const std::string& file, bool pedal);

/// Records the run, flushed every 30 ms. A disk that fails stops the recording, not the run;
/// `finish` then throws what it said. One that stalls holds up this thread alone.
class RecorderThread {
 public:
  /// `ends` is called on its thread, with the reason, where the disk fails; it must not throw.
  RecorderThread(RecordFeed& feed, RecordingWriter writer,
                 std::function<void(std::exception_ptr)> ends)
      : feed_(feed), writer_(std::move(writer)), ends_(std::move(ends)), thread_(feed) {}

  /// Starts the thread; its first flush gives the recording its name.
  void start();
  /// As FeedThread: waits for the rest to be on disk.
  void finish() { thread_.finish(); }
  /// After `finish`, once: writes summary.json of the run, nothing where that is empty, and closes
  /// the recording. std::runtime_error as RecordingWriter; nothing after a failure.
  void close(std::string_view summary);

 private:
  void run();
  bool write_some();
  void write_pieces();
  void write_states();

  RecordFeed& feed_;
  std::optional<RecordingWriter> writer_;  // none once the disk has failed
  std::function<void(std::exception_ptr)> ends_;
  std::optional<std::uint64_t> last_tick_;  // of the rows that have come
  double pedal_ = 1.0;                      // of the last of them
  FeedThread thread_;
};

}  // namespace sulcus
