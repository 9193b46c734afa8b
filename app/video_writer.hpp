#pragma once

#include <cstdio>
#include <string>

#include "engine/graphics/image.hpp"

namespace sulcus {

/// Pipes pictures to ffmpeg, which writes them as a video.
class VideoWriter {
 public:
  /// Throws std::runtime_error where ffmpeg cannot be started.
  VideoWriter(const std::string& file, int width, int height, double fps);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  // Both throw std::runtime_error, naming the file, where ffmpeg has stopped or failed.
  void add(const Image& image);
  void close();

 private:
  std::string file_;
  std::FILE* pipe_ = nullptr;
};

}  // namespace sulcus
