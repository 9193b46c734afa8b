#pragma once

#include <cstdint>
#include <future>
#include <string>
#include <vector>

#include "app/session/feed_thread.hpp"
#include "app/session/session.hpp"
#include "app/session/simulation.hpp"
#include "engine/graphics/renderer.hpp"

namespace sulcus {

/// Draws the run from its own copies of the volumes: a frame each 1 / fps of the run's time, into
/// frames/%06d.png. A renderer that fails does not stop the run; `finish` then throws what it said.
class RenderThread {
 public:
  /// Returns once the first frame can be drawn, so that nothing is set up beside the first ticks.
  /// At real pace only the latest of several frames due is drawn, so that the picture keeps up. Of
  /// the simulation it keeps the scene and the burr, which outlive it, as do the options.
  RenderThread(Feed& feed, const Simulation& simulation, const SessionOptions& options);

  /// As FeedThread: waits for the last frame.
  void finish() { thread_.finish(); }
  // After `finish`.
  std::uint64_t frames() const { return frames_; }
  double seconds() const { return seconds_; }  // spent drawing and writing
  std::size_t memory_bytes() const { return memory_bytes_; }

 private:
  void run();

  Feed& feed_;
  const Scene& scene_;
  const Burr& burr_;
  const SessionOptions& options_;
  std::vector<RenderedBody> bodies_;
  std::uint64_t frames_ = 0;
  double seconds_ = 0.0;
  std::size_t memory_bytes_ = 0;
  std::promise<void> ready_;
  bool is_ready_ = false;  // of the render thread
  FeedThread thread_;
};

}  // namespace sulcus
