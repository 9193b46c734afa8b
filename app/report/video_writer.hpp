#pragma once

#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "app/terminal/child_process.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/graphics/image.hpp"

namespace sulcus {

/// Pipes pictures to ffmpeg, which writes them as a video.
class VideoWriter {
 public:
  /// The name's end says which kind of video. `sound`: a .wav that is there until `close`; empty:
  /// it has none. @throws as WholeFile, before anything is drawn; std::runtime_error where ffmpeg
  /// cannot be started.
  VideoWriter(const std::string& file, int width, int height, double fps,
              const std::string& sound = {});

  // Both throw std::runtime_error, naming the file and what ffmpeg said, where it has stopped or
  // failed.
  void add(const Image& image);
  void close();

 private:
  using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

  [[noreturn]] void fail() const;

  WholeFile video_;
  Stream said_, pictures_;  // its error stream, a file; its input, a pipe
  std::optional<ChildProcess> ffmpeg_;
};

}  // namespace sulcus
