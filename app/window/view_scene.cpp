#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/playback/continued_run.hpp"
#include "app/playback/saved_scene.hpp"
#include "app/playback/scene_trajectory.hpp"
#include "app/report/log_file.hpp"
#include "app/report/results.hpp"
#include "app/session/frame_history.hpp"
#include "app/session/live_film.hpp"
#include "app/session/loaded_run.hpp"
#include "app/session/session.hpp"
#include "app/terminal/progress.hpp"
#include "app/window/mouse_device.hpp"
#include "app/window/view_windows.hpp"
#include "engine/core/error.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/stop.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/graphics/gl_scene.hpp"
#include "engine/graphics/panels.hpp"
#include "engine/graphics/window.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/scene_keys.hpp"

namespace sulcus {

namespace {

constexpr double kLongest_s = 24.0 * 3600.0;  // of a run under the mouse

/// A scene for the hand: what it does not name but needs is added. The tool hangs on a coupling, or
/// the mouse would push it through the tooth, and what was done is recorded.
Scene scene_for_the_hand(const ViewOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  const Scene as_written = load_scene(options.file, overrides);
  if (as_written.trajectory.load_N) {
    throw InputError(options.file, "trajectory.load_N", "a tool that moves by itself",
                     "a scene without it: the mouse holds the burr");
  }
  if (!as_written.coupling) overrides.emplace_back("coupling.evaluations=5");
  if (!as_written.record) overrides.emplace_back("record.queue_s=10");
  return load_scene(options.file, overrides);
}

/// The burr under the mouse: in the plane of the picture, away from the eye with shift, tilted
/// about its tip with control.
class HeldBurr {
 public:
  explicit HeldBurr(const Pose& start) : pose_(start) {}

  bool drag(const WindowInput& input, const View& view, int height) {
    if (!input.left || input.drag.isZero()) return false;
    const Eigen::Vector3d right = view.right_world.cast<double>(),
                          up = view.up_world.cast<double>(), back = view.back_world.cast<double>();
    if (input.control) {
      constexpr double kTilt = 1.0;  // rad for half a height
      pose_.orientation = Eigen::AngleAxisd(kTilt * input.drag.x(), back) *
                          Eigen::AngleAxisd(-kTilt * input.drag.y(), right) * pose_.orientation;
      pose_.orientation.normalize();
      return true;
    }
    const double half_m = 0.5 * height * view.metres_per_pixel;
    pose_.position += half_m * input.drag.x() * right;
    pose_.position += half_m * input.drag.y() * (input.shift ? Eigen::Vector3d(-back) : up);
    return true;
  }
  const Pose& pose() const { return pose_; }

 private:
  Pose pose_;
};

/// One run of it: from the start, or from a time of the one before.
struct Part {
  std::unique_ptr<Simulation> simulation;
  Pose start;  // of the hand
  SessionOptions session;
  std::vector<PartUse> loading;
  std::optional<ResultsFolder> folder;
};

/// What the user asked for when a part ended.
struct GoOn {
  double at_s;
  std::vector<std::string> overrides;
};

std::vector<std::string> overrides_of(const LiveControls& live) {
  std::vector<std::string> overrides{"burr.speed_rpm=" + std::to_string(live.speed_rpm)};
  if (live.other_burr) {
    overrides.push_back("burr.shape=" + std::string(live.burr_shapes[live.burr_shape]));
    overrides.push_back("burr.diameter_mm=" + std::to_string(live.burr_mm));
  }
  return overrides;
}

/// Beside the recording of a part.
std::string save_scene(const Part& part, const PictureControls& picture) {
  if (part.session.earlier) {
    throw InputError(part.session.folder, "", "a part that goes on from another",
                     "one from the start on, which alone a scene does again");
  }
  const std::string& folder = part.folder.value().at();
  write_whole_file(
      folder + "/scene.toml",
      saved_scene(part.simulation->scene(), folder + "/recording.h5", picture.section()));
  return part.folder->path() + "/scene.toml";
}

/// Runs a part in the window until that is closed or another part is asked for.
std::optional<GoOn> run_part(Part& part, Window& window, ViewCamera& camera, LiveControls& live) {
  const Scene& scene = part.simulation->scene();
  std::vector<RenderedBody> bodies = rendered_bodies(*part.simulation);
  HeldBurr burr(part.start);
  MouseDevice device(burr.pose(), scene.haptics.rate_hz);
  std::atomic<bool> paused{true};  // until it can be seen
  std::optional<GoOn> go_on;
  live.first_s = std::numeric_limits<float>::max();
  part.session.paused = &paused;
  const std::uint64_t first_tick = part.simulation->state().tick;
  part.session.watch = [&](Feed& feed) {
    RenderSettings settings = scene.render.value_or(RenderSettings{});
    settings.width = window.size().x();
    settings.height = window.size().y();
    LiveFilm film(feed, scene, bodies.front().model, part.session.earlier.get());
    if (scene.heat) film.show_heat(scene, bodies.front().model, first_tick);
    GlScene drawing(settings, std::move(bodies), part.simulation->burr().mesh_tool,
                    part.simulation->burr().head_length_m);
    drawing.set_hurried(true);
    while (window.is_open() && !go_on && !feed.ended && !stop_requested()) {
      const WindowInput input = window.begin();
      for (const char key : input.keys) {
        if (key == ' ') live.paused = !live.paused;
      }
      draw_panels(live);
      paused = live.paused;
      while (film.take()) {
      }
      camera.follow(input);
      if (input.right) camera.turn(input);
      if (input.middle) camera.move(input);
      if (burr.drag(input, drawing.view(), window.size().y())) device.go_to(burr.pose());
      const bool turning = input.right || input.middle || input.wheel != 0.0;
      set_picture(drawing, camera, live.picture, window, turning);
      FrameState state;
      if (film.empty()) {
        state.world_from_tool = burr.pose();
      } else {
        state = film.bring(drawing, LiveFilm::Pieces::kThatAreThere);
        state.device = burr.pose();
        live.time_s = static_cast<float>(state.time_s);
        live.first_s = std::min(live.first_s, live.time_s);
      }
      drawing.draw(state);
      window.end(drawing.frame());
      if (live.save_asked) {
        try {
          live.said = save_scene(part, live.picture);
        } catch (const std::exception& error) {  // the window stays
          live.said = error.what();
        }
      }
      if (live.go_on_asked && !film.empty()) {
        go_on = {static_cast<double>(live.time_s) - static_cast<double>(live.back_s),
                 overrides_of(live)};
      }
    }
  };
  run_into(part.folder.value(), *part.simulation, device, part.session, part.loading);
  return go_on;
}

/// The part that goes on from a time of one that has ended. It keeps its own folder.
Part part_after(const std::string& recording, const GoOn& from, const std::string& folder) {
  RecordedRun run = open_recorded_run(recording);
  const std::size_t row = row_at(run.rows, from.at_s);
  Part part;
  ContinuedRun continued = continue_run(run, row, from.overrides);
  part.simulation = std::move(continued.simulation);
  part.session.earlier = std::move(continued.earlier);
  part.session.parent = std::move(continued.parent);
  part.session.goal = run.reader.goal();
  part.session.input = run.reader.input();
  part.start = pose_of(run.rows[row].device_position_m, run.rows[row].device_orientation);
  part.folder.emplace(ResultsPlace{{}, folder});
  return part;
}

}  // namespace

void view_scene(const ViewOptions& options) {
  const Scene scene = scene_for_the_hand(options);
  const Trajectory trajectory = scene_trajectory(scene);
  LoadCache cache = LoadCache::of_user();
  Part part;
  part.start = trajectory.pose_at(0.0);
  std::optional<Progress> loading(std::in_place, "loading");
  LoadedRun loaded = load_run(scene, part.start, cache);
  loading.reset();
  leave_realtime_core();  // the haptic thread's; the rasteriser's threads stay with this one
  Window window("Sulcus: " + scene.title, options.width, options.height);
  ViewCamera camera(scene.render ? scene.render->camera : Camera::kReview);
  LiveControls live;
  live.speed_rpm = static_cast<float>(scene.burr.speed_rad_per_s / kRevolutionPerMinute);
  live.burr_mm = static_cast<float>(scene.burr.diameter_m / kMillimetre);
  live.burr_shapes = find_scene_key("burr", "shape")->words;
  if (scene.burr.shape != BurrShape::kFile) {
    live.burr_shape = static_cast<std::size_t>(scene.burr.shape);
  }

  part.folder.emplace(
      ResultsPlace{options.folder, folder_of_scene(options.file, "_view"), options.force});
  const std::string folder = part.folder->path();
  open_log(part.folder->at());
  log_loading(scene, loaded, cache);
  part.simulation = std::move(loaded.simulation);
  part.session.goal = std::move(loaded.goal);
  part.session.input = loaded.notes.input;
  part.loading = std::move(loaded.loading);
  const EndsItself stopped_by_itself;
  for (int number = 2;; ++number) {
    part.session.pace = Pace::kReal;
    part.session.render = false;
    part.session.ticks = static_cast<std::uint64_t>(kLongest_s * scene.haptics.rate_hz);
    std::optional<GoOn> go_on = run_part(part, window, camera, live);
    if (!go_on) return;
    const std::string recording = part.folder->path() + "/recording.h5";
    live.paused = true;  // until the user takes it up again
    live.said = "goes on from " + std::to_string(go_on->at_s) + " s";
    const std::string next = folder + "/part_" + std::to_string(number);
    try {
      part = part_after(recording, *go_on, next);
    } catch (const InputError& error) {  // the other burr cannot be there: on with the one before
      live.said = error.what();
      std::erase_if(go_on->overrides, is_other_burr);
      part = part_after(recording, *go_on, next);
    }
    live.other_burr = false;  // it is this part's own now
    open_log(part.folder->at());
  }
}

}  // namespace sulcus
