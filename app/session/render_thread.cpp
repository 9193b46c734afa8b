#include "app/session/render_thread.hpp"

#include <chrono>
#include <filesystem>
#include <optional>
#include <utility>

#include "app/session/frame_history.hpp"
#include "app/session/live_film.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/stop.hpp"

namespace sulcus {

RenderThread::RenderThread(Feed& feed, const Simulation& simulation, const SessionOptions& options)
    : feed_(feed),
      scene_(simulation.scene()),
      burr_(simulation.burr()),
      options_(options),
      bodies_(rendered_bodies(simulation)),
      thread_(feed) {
  std::future<void> ready = ready_.get_future();
  thread_.start([this] { run(); },
                [this] {
                  if (!is_ready_) ready_.set_value();  // `finish` says what went wrong
                });
  ready.wait();
}

void RenderThread::run() {
  const bool drop_frames = options_.pace == Pace::kReal;
  // Pinned before the context is made: the software rasteriser's threads inherit it.
  if (drop_frames) leave_realtime_core();
  std::filesystem::create_directories(options_.folder + "/frames");
  LiveFilm film(feed_, scene_, bodies_.front().model, options_.earlier.get());
  Renderer renderer(*scene_.render, std::move(bodies_), burr_.mesh_tool, burr_.head_length_m);
  // It is more to draw in each frame, and the ticks need the processor.
  renderer.set_handpiece(false);
  is_ready_ = true;
  ready_.set_value();

  // A run that drops frames does not wait for pieces, nor for all light, but for its last picture.
  const auto draw = [&](LiveFilm::Pieces pieces) {
    renderer.set_hurried(pieces == LiveFilm::Pieces::kThatAreThere);
    const std::uint64_t begin = steady_ns();
    const Image image = renderer.draw(film.bring(renderer, pieces));
    write_png(image, options_.folder + formatted("/frames/%06ju.png", std::uintmax_t{frames_++}));
    seconds_ += seconds_since(begin);
  };

  std::uint64_t frame = 0;  // due at frame / fps
  drain_until_ended(feed_, std::chrono::milliseconds(2), [&] {
    bool due = false;
    while (const std::optional<TickReport> report = film.take()) {
      const double frames_s = report->record.time_s * scene_.render->fps;
      if (frames_s < static_cast<double>(frame)) continue;
      frame = static_cast<std::uint64_t>(frames_s) + 1;
      if (stop_requested()) continue;  // who stops a run does not wait for its pictures
      if (drop_frames) {
        due = true;
      } else {
        draw(LiveFilm::Pieces::kAll);
      }
    }
    if (due && !stop_requested()) draw(LiveFilm::Pieces::kThatAreThere);
  });
  if (!film.empty() && !stop_requested()) draw(LiveFilm::Pieces::kAll);  // the result
  memory_bytes_ = renderer.memory_bytes();
}

}  // namespace sulcus
