#pragma once

#include <mutex>
#include <string>

#include <spdlog/sinks/base_sink.h>

namespace sulcus {

/// A log as a file, written line by line while a run goes on: what it holds is there when the
/// process is killed. Where the disk is full it ends with the last whole line.
class LogFile : public spdlog::sinks::base_sink<std::mutex> {
 public:
  /// Begins it anew. @throws InputError where it cannot be written, or is no regular file: a link
  /// or a pipe; std::runtime_error where the disk is full.
  explicit LogFile(std::string path);
  ~LogFile() override;

  /// Whether all lines are in it. @throws std::runtime_error with the reason where they are not.
  void check();

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override {}

 private:
  std::string path_;
  int file_;
  std::size_t bytes_ = 0;  // of whole lines
  int error_ = 0;          // of the line that could not be written
};

/// Starts log.txt in a folder that it makes; messages also go to the terminal. InputError where the
/// folder cannot be written.
void open_log(const std::string& folder);

/// Throws where log.txt lacks a line that was logged, as LogFile::check.
void check_log();

}  // namespace sulcus
