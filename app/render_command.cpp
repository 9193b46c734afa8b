#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "app/commands.hpp"
#include "app/frame_history.hpp"
#include "app/recorded_run.hpp"
#include "app/render_thread.hpp"
#include "engine/core/error.hpp"

namespace sulcus {

namespace {

struct RenderOptions {
  std::string recording, folder, size, camera, video;
  std::vector<double> at_s;
  double fps = 0.0;
};

/// Pipes pictures to ffmpeg.
class VideoWriter {
 public:
  VideoWriter(const std::string& file, int width, int height, double fps) : file_(file) {
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
  ~VideoWriter() {
    if (pipe_) pclose(pipe_);
  }
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  void add(const Image& image) {
    if (std::fwrite(image.rgb.data(), 1, image.rgb.size(), pipe_) != image.rgb.size()) {
      throw std::runtime_error(file_ + ": ffmpeg stopped (is it installed?)");
    }
  }
  void close() {
    const int status = pclose(pipe_);
    pipe_ = nullptr;
    if (status != 0) throw std::runtime_error(file_ + ": ffmpeg could not write it");
  }

 private:
  std::string file_;
  std::FILE* pipe_ = nullptr;
};

/// Rows to be drawn, rising: those of --at, else every 1 / fps, else the last.
std::vector<std::size_t> rows_to_draw(const RecordedShape& shape, const RenderOptions& options) {
  std::vector<std::size_t> rows;
  for (double time_s : options.at_s) rows.push_back(shape.row_at(time_s));
  std::sort(rows.begin(), rows.end());
  if (options.fps > 0.0) {
    const double end_s = shape.rows().back().time_s;
    for (std::uint64_t frame = 0; static_cast<double>(frame) / options.fps <= end_s; ++frame) {
      rows.push_back(shape.row_at(static_cast<double>(frame) / options.fps));
    }
  }
  if (rows.empty()) rows.push_back(shape.rows().size() - 1);
  return rows;
}

RenderSettings render_settings(const Scene& scene, const RenderOptions& options) {
  RenderSettings settings = scene.render.value_or(RenderSettings{});
  if (!options.size.empty()) {
    const char *begin = options.size.data(), *end = begin + options.size.size();
    const auto width = std::from_chars(begin, end, settings.width);
    const bool by = width.ec == std::errc{} && width.ptr != end && *width.ptr == 'x';
    const auto height = std::from_chars(by ? width.ptr + 1 : end, end, settings.height);
    const auto fits = [](int pixels) { return pixels >= 16 && pixels <= 8192; };
    if (!by || height.ec != std::errc{} || height.ptr != end || !fits(settings.width) ||
        !fits(settings.height)) {
      throw InputError("", "--size", "'" + options.size + "'", "WxH, 16 to 8192 each");
    }
  }
  if (!options.camera.empty()) {
    const auto found = std::find(kCameraNames.begin(), kCameraNames.end(), options.camera);
    settings.camera = Camera(found - kCameraNames.begin());
  }
  return settings;
}

void render(RenderOptions options) {
  const RecordingReader reader(options.recording);
  if (reader.tick_count() == 0) {
    throw InputError(options.recording, "/ticks", "no rows", "at least one tick");
  }
  if (!reader.missing().empty()) std::fprintf(stderr, "sulcus: %s\n", reader.missing().c_str());
  if (!options.at_s.empty() && options.fps > 0.0) {
    throw InputError("", "--fps", "both --at and --fps", "one of them");
  }
  const bool video = !options.video.empty();
  if (video && options.fps <= 0.0) options.fps = 30.0;
  const Scene scene = recorded_scene(reader, options.recording);
  const Burr burr = recorded_burr(reader, scene);
  const RenderSettings settings = render_settings(scene, options);
  RecordedShape shape(reader, recorded_workpiece(reader, scene));
  FrameHistory history(scene, shape.model());
  Renderer renderer(settings, rendered_bodies(scene, shape.model(), recorded_bodies(reader, scene)),
                    burr.mesh_tool, burr.head_length_m);

  std::unique_ptr<VideoWriter> writer;
  if (video) {
    writer =
        std::make_unique<VideoWriter>(options.video, settings.width, settings.height, options.fps);
  }
  if (options.folder.empty()) {
    options.folder = (std::filesystem::path(options.recording).parent_path() / "render").string();
  }
  if (!video) std::filesystem::create_directories(options.folder);

  std::vector<std::vector<std::uint32_t>> removed(1 + scene.bodies.size());  // by body
  RecordedPieces pieces(reader);
  const std::vector<CuttingRecord> cutting = reader.cutting();
  const std::vector<PortRecord> port = reader.port();
  std::size_t next = 0;
  std::uint64_t frame = 0;
  for (std::size_t row : rows_to_draw(shape, options)) {
    for (; next <= row; ++next) {
      history.add(shape.rows()[next], next < cutting.size() ? &cutting[next] : nullptr,
                  next < port.size() ? &port[next] : nullptr);
    }
    for (std::vector<std::uint32_t>& voxels : removed) voxels.clear();
    for (const Edit& edit : shape.seek_row(row)) {
      removed[edit.body].push_back(edit.voxel);
      history.add(edit);
    }
    for (std::size_t body = 0; body < removed.size(); ++body) renderer.remove(body, removed[body]);
    FrameState state = history.state();
    for (const auto& voxels : pieces.advance_to_tick(state.tick)) {
      if (!voxels.empty()) renderer.add_piece(voxels);
    }
    state.pieces = pieces.poses();
    const Image image = renderer.draw(state);
    if (writer) {
      writer->add(image);
      continue;
    }
    char name[32];
    std::snprintf(name, sizeof(name), "/%06llu.png", static_cast<unsigned long long>(frame++));
    write_png(image, options.folder + name);
    if (options.fps <= 0.0) std::printf("%s%s\n", options.folder.c_str(), name);
  }
  if (writer) {
    writer->close();
    std::printf("%s\n", options.video.c_str());
  } else if (options.fps > 0.0) {
    std::printf("%s: %llu pictures\n", options.folder.c_str(),
                static_cast<unsigned long long>(frame));
  }
}

}  // namespace

void add_render_command(CLI::App& program) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* command = program.add_subcommand("render", "Draw pictures or a video of a recording");
  command->add_option("RECORDING", options->recording, "Recording, .h5")->required();
  command->add_option("-o", options->folder, "Folder for the pictures (render/ beside it)");
  command->add_option("--at", options->at_s, "Time to draw, s; repeatable (the end)")
      ->expected(1)
      ->take_all();
  command->add_option("--fps", options->fps, "Draw the whole run, this many pictures a second")
      ->check(CLI::Range(0.01, 1000.0));
  command->add_option("--size", options->size, "Pixels, WxH");
  command->add_option("--camera", options->camera, "review, occlusal, buccal, mesial or burr")
      ->check(CLI::IsMember({"review", "occlusal", "buccal", "mesial", "burr"}));
  command->add_option("--video", options->video, "Write an MP4 (30 pictures a second)");
  command->callback([options] { render(*options); });
}

}  // namespace sulcus
