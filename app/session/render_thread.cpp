#include "app/session/render_thread.hpp"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "app/session/live_film.hpp"
#include "app/session/rendered_bodies.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/stop.hpp"

namespace sulcus {

RenderThread::RenderThread(Feed& feed, PieceFeed* pieces, const Scene& scene, VoxelModel start,
                           std::vector<VoxelModel> bodies, const Burr& burr,
                           const EarlierRun* earlier, std::string folder, bool drop_frames)
    : feed_(feed),
      pieces_(pieces),
      scene_(scene),
      bodies_(rendered_bodies(scene, std::move(start), std::move(bodies))),
      burr_(burr),
      earlier_(earlier),
      folder_(std::move(folder)),
      drop_frames_(drop_frames) {
  std::future<void> ready = ready_.get_future();
  thread_ = std::thread([this] {
    try {
      run();
    } catch (...) {
      failure_ = std::current_exception();
      feed_.gone = true;
      if (!is_ready_) ready_.set_value();  // `finish` says what went wrong
    }
  });
  ready.wait();
}

RenderThread::~RenderThread() {
  if (thread_.joinable()) {
    feed_.ended = true;
    thread_.join();
  }
}

void RenderThread::finish() {
  thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}

void RenderThread::run() {
  // Pinned before the context is made: the software rasteriser's threads inherit it.
  if (drop_frames_) leave_realtime_core();
  std::filesystem::create_directories(folder_ + "/frames");
  LiveFilm film(feed_, pieces_, scene_, bodies_.front().model, earlier_);
  Renderer renderer(*scene_.render, std::move(bodies_), burr_.mesh_tool, burr_.head_length_m);
  // It is more to draw in each frame, and the ticks need the processor.
  renderer.set_handpiece(false);
  is_ready_ = true;
  ready_.set_value();

  // A run that drops frames does not wait for pieces, nor for all light, but for its last picture.
  const auto draw = [&](bool wait) {
    renderer.set_hurried(!wait);
    const std::uint64_t begin = steady_ns();
    const Image image = renderer.draw(film.bring(renderer, wait));
    char name[32];
    std::snprintf(name, sizeof(name), "/frames/%06llu.png",
                  static_cast<unsigned long long>(frames_++));
    write_png(image, folder_ + name);
    seconds_ += 1e-9 * static_cast<double>(steady_ns() - begin);
  };

  std::uint64_t frame = 0;  // due at frame / fps
  for (bool ended = false; !ended;) {
    ended = feed_.ended.load();
    bool due = false;
    while (const std::optional<TickReport> report = film.take()) {
      const double frames_s = report->record.time_s * scene_.render->fps;
      if (frames_s < static_cast<double>(frame)) continue;
      frame = static_cast<std::uint64_t>(frames_s) + 1;
      if (stop_requested()) continue;  // who stops a run does not wait for its pictures
      if (drop_frames_) {
        due = true;
      } else {
        draw(true);
      }
    }
    if (due && !stop_requested()) draw(false);
    if (!ended && !due) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (!film.empty() && !stop_requested()) draw(true);  // the last picture is the result
  memory_bytes_ = renderer.memory_bytes();
}

}  // namespace sulcus
