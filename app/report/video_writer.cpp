#include "app/report/video_writer.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "app/terminal/terminal.hpp"

namespace sulcus {

VideoWriter::VideoWriter(const std::string& file, int width, int height, double fps,
                         const std::string& sound)
    : video_(file), said_(std::tmpfile(), std::fclose), pictures_(nullptr, std::fclose) {
  std::array<int, 2> ends{};
  if (!said_ || ::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(file + ": no room for what ffmpeg reads and writes");
  }
  std::istringstream words(
      "ffmpeg -v error -xerror -y -f rawvideo -pix_fmt rgb24 -i - -vf "
      "pad=ceil(iw/2)*2:ceil(ih/2)*2 "
      "-c:v libx264 -preset fast -crf 18 -pix_fmt yuv420p -movflags +faststart");
  std::vector<std::string> command{std::istream_iterator<std::string>(words), {}};
  const auto input = std::ranges::find(command, "-i");
  command.insert(input, {"-s", formatted("%dx%d", width, height), "-r", formatted("%.6g", fps)});
  // "file:", since ffmpeg takes what comes before a colon in a name for a protocol, and a dash
  // ahead of it for an option.
  if (!sound.empty()) {
    const auto after_input = std::ranges::find(command, "-i") + 2;
    command.insert(after_input, {"-i", "file:" + sound, "-c:a", "aac", "-b:a", "160k"});
  }
  command.push_back("file:" + video_.beside());
  pictures_.reset(::fdopen(ends[1], "wb"));
  try {
    ffmpeg_.emplace(command, ChildProcess::Files{ends[0], -1, fileno(said_.get())});
  } catch (...) {
    ::close(ends[0]);
    throw;
  }
  ::close(ends[0]);
}

void VideoWriter::add(const Image& image) {
  if (std::fwrite(image.rgb.data(), 1, image.rgb.size(), pictures_.get()) == image.rgb.size())
    return;
  pictures_.reset();
  ffmpeg_->wait();
  fail();
}

void VideoWriter::close() {
  const bool piped = std::fclose(pictures_.release()) == 0;
  if (ffmpeg_->wait() != 0 || !piped) fail();
  video_.finish();
}

void VideoWriter::fail() const {
  std::string line;
  std::rewind(said_.get());
  for (int c; (c = std::fgetc(said_.get())) != EOF && c != '\n';) line += static_cast<char>(c);
  video_.fail_incomplete("ffmpeg could not" + (line.empty() ? "" : " (" + line + ")"));
}

}  // namespace sulcus
