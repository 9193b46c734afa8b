#include "app/video_writer.hpp"

#include <cstdlib>
#include <stdexcept>

namespace sulcus {

VideoWriter::VideoWriter(const std::string& file, int width, int height, double fps) : file_(file) {
  // The name goes through the environment, so that no character of it means anything to a shell.
  setenv("SULCUS_VIDEO", file.c_str(), 1);
  char command[256];
  std::snprintf(command, sizeof(command),
                "exec ffmpeg -v error -y -f rawvideo -pix_fmt rgb24 -s %dx%d -r %.6g -i - "
                "-vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -c:v libx264 -preset fast -crf 18 "
                "-pix_fmt yuv420p -movflags +faststart \"$SULCUS_VIDEO\"",
                width, height, fps);
  pipe_ = popen(command, "w");
  if (!pipe_) throw std::runtime_error(file + ": ffmpeg could not be started");
}

VideoWriter::~VideoWriter() {
  if (pipe_) pclose(pipe_);
}

void VideoWriter::add(const Image& image) {
  if (std::fwrite(image.rgb.data(), 1, image.rgb.size(), pipe_) != image.rgb.size()) {
    throw std::runtime_error(file_ + ": ffmpeg stopped (is it installed?)");
  }
}

void VideoWriter::close() {
  const int status = pclose(pipe_);
  pipe_ = nullptr;
  if (status != 0) throw std::runtime_error(file_ + ": ffmpeg could not write it");
}

}  // namespace sulcus
