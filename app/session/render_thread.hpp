#pragma once

#include <exception>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include "app/session/feed.hpp"
#include "app/session/piece_feed.hpp"
#include "engine/graphics/renderer.hpp"
#include "engine/recording/earlier_run.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Draws the run from its own copies of the volumes: a frame each 1 / fps of the run's time, into
/// frames/%06d.png. It reads its feed and nothing else of the haptic thread. A renderer that fails
/// does not stop the run; `finish` then throws what it said.
class RenderThread {
 public:
  /// Returns once the first frame can be drawn, so that nothing is set up beside the first ticks.
  /// `folder` holds frames/. `drop_frames`: of several frames due only the latest is drawn, so that
  /// the picture keeps up with a run at real pace. Scene, burr and `earlier`, which is null but for
  /// a run that goes on from another, outlive the thread. `pieces` is null where none may come
  /// loose.
  RenderThread(Feed& feed, PieceFeed* pieces, const Scene& scene, VoxelModel start,
               std::vector<VoxelModel> bodies, const Burr& burr, const EarlierRun* earlier,
               std::string folder, bool drop_frames);
  ~RenderThread();
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  /// After `feed.ended`: waits for the last frame.
  void finish();
  std::uint64_t frames() const { return frames_; }
  double seconds() const { return seconds_; }  // spent drawing and writing
  std::size_t memory_bytes() const { return memory_bytes_; }

 private:
  void run();

  Feed& feed_;
  PieceFeed* pieces_;
  const Scene& scene_;
  std::vector<RenderedBody> bodies_;
  const Burr& burr_;
  const EarlierRun* earlier_;
  std::string folder_;
  bool drop_frames_;
  std::uint64_t frames_ = 0;
  double seconds_ = 0.0;
  std::size_t memory_bytes_ = 0;
  std::promise<void> ready_;
  bool is_ready_ = false;  // of the render thread
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sulcus
