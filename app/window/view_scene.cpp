#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/live/live_device.hpp"
#include "app/live/live_health.hpp"
#include "app/live/live_part.hpp"
#include "app/live/scene_device.hpp"
#include "app/playback/saved_scene.hpp"
#include "app/playback/scene_trajectory.hpp"
#include "app/report/log_file.hpp"
#include "app/report/results.hpp"
#include "app/session/frame_history.hpp"
#include "app/session/live_film.hpp"
#include "app/session/loaded_run.hpp"
#include "app/session/session.hpp"
#include "app/stream/stream_port.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/terminal.hpp"
#include "app/window/goal_view.hpp"
#include "app/window/held_burr.hpp"
#include "app/window/mouse_device.hpp"
#include "app/window/picture_tools.hpp"
#include "app/window/rewind_film.hpp"
#include "app/window/view_keys.hpp"
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

/// What is added to a scene for the hand: the tool hangs on a coupling, or the hand would push it
/// through the tooth, and what was done is recorded.
std::vector<std::string> overrides_for_the_hand(const ViewOptions& options,
                                                const std::string& text) {
  std::vector<std::string> overrides = options.overrides;
  const Scene as_written = parse_scene(text, options.file, overrides);
  if (as_written.trajectory.load_N) {
    throw InputError(options.file, "trajectory.load_N", "a tool that moves by itself",
                     "a scene without it: a hand holds the burr");
  }
  if (!as_written.coupling) overrides.emplace_back("coupling.evaluations=5");
  if (!as_written.record) overrides.emplace_back("record.queue_s=10");
  return overrides;
}

/// A device that a hand holds, or one that is simulated with its hand.
bool has_hand(const Scene& scene) { return scene.device && !scene.device->played_back; }

/// Who holds the burr: the mouse, or the scene's device, which is held on to through all parts.
class Holder {
 public:
  /// `device`: null where it is the mouse.
  Holder(const Scene& scene, std::unique_ptr<SceneDevice> device)
      : rate_hz_(scene.haptics.rate_hz), burrs_(scene.burrs.size()), device_(std::move(device)) {}
  /// Whatever ends the parts, no force stays.
  ~Holder() {
    if (live_) live_->finish();
  }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;

  bool by_mouse() const { return !device_; }
  LiveDevice& device() { return live_.value(); }
  MouseDevice* mouse() { return mouse_ ? &*mouse_ : nullptr; }
  PluginDevice* plugin() { return device_ ? device_->plugin() : nullptr; }

  /// `burr`: that is in, by its number.
  void begin(const LivePart& part, std::size_t burr) {
    const bool again = live_.has_value();
    if (by_mouse()) {
      live_.reset();
      live_.emplace(mouse_.emplace(part.start, rate_hz_), rate_hz_, false, true, burrs_);
    } else if (!again) {
      live_.emplace(device_->device(), rate_hz_, true, true, burrs_);
    }
    live_->begin_part(again, static_cast<std::uint32_t>(burr));
    if (!plugin()) return;
    const Simulation& simulation = *part.simulation;
    const auto is_free = [&simulation](const Pose& pose) { return simulation.is_free(pose); };
    if (again) {
      plugin()->go_on(is_free);
    } else {
      plugin()->begin(is_free);
    }
  }
  /// After the last part. Throws where a plug-in's device ended the run.
  void end() {
    live_->finish();
    if (device_) device_->end();
  }

 private:
  double rate_hz_;
  std::size_t burrs_;
  std::unique_ptr<SceneDevice> device_;
  std::optional<MouseDevice> mouse_;
  std::optional<LiveDevice> live_;
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
std::string save_scene(const LivePart& part, const PictureControls& picture) {
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

/// What keys and panel ask of who holds the burr.
void control(Holder& holder, LiveControls& live, const std::string& keys) {
  for (const char key : keys) {
    const std::optional<ViewAction> action = action_of(key, false);
    if (action == ViewAction::kPause) live.paused = !live.paused;
    if (action == ViewAction::kSpindle) live.spindle_on = !live.spindle_on;
    if (action == ViewAction::kClutch) live.clutch = !live.clutch;
    if (action == ViewAction::kRecentre) live.recentre_asked = true;
    if (action == ViewAction::kNextBurr && !live.burrs.empty()) {
      live.burr = (live.burr + 1) % live.burrs.size();
    }
  }
  holder.device().set_pedal(live.spindle_on ? static_cast<double>(live.pedal) : 0.0);
  if (!holder.by_mouse()) holder.device().let_go(live.paused);
  if (PluginDevice* const plugin = holder.plugin()) {
    plugin->hold_clutch(live.clutch);
    if (live.recentre_asked) plugin->recentre();
  }
  live.recentre_asked = false;
}

/// A part in the window.
class PartInWindow {
 public:
  PartInWindow(LivePart& part, Holder& holder, Window& window, CameraHand& camera,
               LiveControls& live)
      : part_(part),
        scene_(part.simulation->scene()),
        holder_(holder),
        window_(window),
        camera_(camera),
        live_(live),
        burr_(part.start),
        first_tool_(part.start),
        burr_number_(live.burr),
        bodies_(rendered_bodies(*part.simulation)),
        health_(scene_.haptics.rate_hz) {}

  /// Until the window is closed, the device says that it is over or another part is asked for.
  std::optional<GoOn> run() {
    first_tick_ = part_.simulation->state().tick;
    if (first_tick_ > 0) first_tool_ = part_.simulation->state().tool;
    if (holder_.by_mouse()) part_.session.paused = &paused_;
    part_.session.watch = [this](Feed& feed) { watch(feed); };
    part_.session.recording_ends = [this] { is_recorded_ = false; };
    run_into(part_.folder.value(), *part_.simulation, holder_.device(), part_.session,
             part_.loading);
    if (seconds_ > 0.0) say("  pictures           %.1f a second\n", pictures_ / seconds_);
    const std::uint32_t wanted = holder_.device().wanted_burr();
    if (wanted != kSameBurr) live_.burr = wanted;
    // The device may have said meanwhile that it is over.
    if (!holder_.by_mouse() && !holder_.device().goes_on()) go_on_.reset();
    if (!go_on_ && holder_.device().goes_on() && wanted != kSameBurr) go_on_.emplace();
    return go_on_;
  }

 private:
  void watch(Feed& feed) {
    RenderSettings settings = scene_.render.value_or(RenderSettings{});
    settings.width = window_.size().x();
    settings.height = window_.size().y();
    const Burr& burr = part_.simulation->burr();
    const EarlierRun* const earlier = part_.session.earlier.get();
    RewindFilm rewind(bodies_);
    LiveFilm film(feed, scene_, bodies_.front().model, earlier);
    if (scene_.heat) film.show_heat(scene_, bodies_.front().model, first_tick_);
    GlScene drawing(settings, std::move(bodies_), burr.mesh_tool, burr.head_length_m);
    PictureTools tools(
        scene_, drawing.surface().model(), burr,
        holder_.by_mouse() ? PictureTools::Turns::kRight : PictureTools::Turns::kLeft);
    GoalView plan(scene_, earlier ? earlier->start : drawing.surface().model(),
                  part_.session.goal ? &*part_.session.goal : nullptr);
    drawing.set_hurried(true);
    begin(film, drawing, plan);
    const std::uint64_t begin_ns = steady_ns();
    while (window_.is_open() && !feed.ended && !stop_requested()) {
      show(rewind, film, drawing, tools, plan);
      ++pictures_;
      if (!go_on_) continue;
      if (holder_.by_mouse()) break;
      holder_.device().end_part();  // and on, until the force has fallen
    }
    seconds_ = seconds_since(begin_ns);
  }

  void begin(const LiveFilm& film, const GlScene& drawing, const GoalView& plan) {
    live_.picture.has_plan = plan.has_goal();
    live_.looks_back = false;
    state_ = film.before_the_first(first_tick_, first_tool_);
    live_.time_s = live_.first_s = static_cast<float>(state_.time_s);
    if (!holder_.by_mouse()) return;
    if (burr_.begin(first_tool_, drawing.surface().model(), part_.simulation->burr())) {
      holder_.mouse()->go_to(burr_.pose());
    }
  }

  void show(RewindFilm& rewind, LiveFilm& film, GlScene& drawing, PictureTools& tools,
            GoalView& plan) {
    const WindowInput input = window_.begin();
    draw_panels(live_);
    control(holder_, live_, input.keys);
    paused_ = live_.paused;
    while (const std::optional<TickReport> report = film.take()) {
      health_.add(*report);
      rewind.come_back(drawing);
      rewind.add(*report, film.last_edits());
    }
    live_.timing = health_.timing();
    live_.faults = health_.faults();
    if (!is_recorded_) live_.faults = "not recorded any more " + live_.faults;
    tools.follow(input, drawing, camera_, window_, live_.picture, false);
    if (holder_.by_mouse() &&
        burr_.follow(input, drawing.view(), window_.size().y(), state_.world_from_tool,
                     drawing.surface().model(), part_.simulation->burr())) {
      holder_.mouse()->go_to(burr_.pose());
    }
    set_picture(drawing, camera_, live_.picture, window_, tools.is_moving());
    if (live_.looks_back) drawing.set_hud({.figures = false, .arrows = false});  // of now
    if (!film.empty()) bring(rewind, film, drawing);
    plan.show(drawing, live_.picture);
    drawing.draw(state_);
    tools.end_frame(drawing, state_, camera_, window_, live_.picture, false);
    if (live_.save_asked) save();
    if (!film.empty() && !go_on_) ask_to_go_on();
  }

  /// The drawing to the last tick, or to the time that is looked back to.
  void bring(RewindFilm& rewind, LiveFilm& film, GlScene& drawing) {
    state_ = film.bring(drawing, LiveFilm::Pieces::kThatAreThere);
    if (holder_.by_mouse()) state_.device = burr_.pose();
    live_.time_s = static_cast<float>(state_.time_s);
    live_.first_s = std::min(live_.first_s, live_.time_s);
    if (live_.looks_back) {
      rewind.look_back(static_cast<double>(live_.time_s) - static_cast<double>(live_.back_s),
                       drawing, state_);
    } else {
      rewind.come_back(drawing);
    }
  }

  void save() {
    try {
      check_recording();
      live_.said = save_scene(part_, live_.picture);
    } catch (const std::exception& error) {  // the window stays
      live_.said = error.what();
    }
  }

  /// What is there of this part is all of it: else nothing can go on from it.
  void check_recording() const {
    const std::string file = part_.folder.value().at() + "/recording.h5";
    if (!is_recorded_) throw std::runtime_error(file + ": ends before the run");
    if (!std::filesystem::exists(file)) throw std::runtime_error(file + ": is no longer there");
  }

  void ask_to_go_on() {
    if (!live_.go_on_asked && live_.burr == burr_number_) return;
    try {
      check_recording();
    } catch (const std::exception& error) {  // the window stays
      live_.said = error.what();
      live_.burr = burr_number_;
      return;
    }
    if (live_.go_on_asked) {
      go_on_ = {static_cast<double>(live_.time_s) - static_cast<double>(live_.back_s),
                overrides_of(live_)};
    } else {
      go_on_.emplace();
    }
  }

  LivePart& part_;
  const Scene& scene_;
  Holder& holder_;
  Window& window_;
  CameraHand& camera_;
  LiveControls& live_;
  HeldBurr burr_;    // of the mouse
  Pose first_tool_;  // before the first tick
  std::size_t burr_number_;
  std::vector<RenderedBody> bodies_;
  LiveHealth health_;
  FrameState state_;  // that is drawn
  std::uint64_t first_tick_ = 0;
  std::atomic<bool> paused_{true};  // until it can be seen
  std::atomic<bool> is_recorded_{true};
  std::optional<GoOn> go_on_;
  double pictures_ = 0.0, seconds_ = 0.0;
};

/// The panel says what is in.
void take_burr(const Scene& scene, LiveControls& live) {
  live.speed_rpm = static_cast<float>(scene.burr.speed_rad_per_s / kRevolutionPerMinute);
  live.burr_mm = static_cast<float>(scene.burr.diameter_m / kMillimetre);
}

LiveControls controls_of(const Scene& scene, bool by_mouse) {
  LiveControls live;
  live.by_mouse = by_mouse;
  live.burr_shapes = find_scene_key("burr", "shape")->words;
  const Range& diameter = find_scene_key("burr", "diameter_mm")->range;
  live.least_burr_mm = static_cast<float>(diameter.least);
  live.most_burr_mm = static_cast<float>(diameter.most);
  if (scene.burr.shape != BurrShape::kFile) {
    live.burr_shape = static_cast<std::size_t>(scene.burr.shape);
  }
  for (const BurrChoice& burr : scene.burrs) live.burrs.push_back(burr.name);
  return live;
}

}  // namespace

void view_scene(const ViewOptions& options) {
  const std::string text = read_scene_text(options.file);  // once: it may be a pipe
  Scene scene = parse_scene(text, options.file, overrides_for_the_hand(options, text));
  const Trajectory trajectory = scene_trajectory(scene);
  const bool by_mouse = options.mouse || !has_hand(scene);
  std::unique_ptr<PluginDevice> plugin =
      by_mouse ? nullptr : open_plugin(options.plugin_folders, true, trajectory, scene);
  // For all parts: who was connected to one may come again to the next.
  std::shared_ptr<StreamPort> stream;
  if (scene.stream) stream = std::make_shared<StreamPort>(scene);
  LoadCache cache = LoadCache::of_user();
  LivePart part;
  part.start = trajectory.pose_at(0.0);
  std::optional<Progress> loading(std::in_place, "loading");
  LoadedRun loaded = load_run(scene, part.start, cache);
  loading.reset();
  leave_realtime_core();  // the haptic thread's; the rasteriser's threads stay with this one
  Window window("Sulcus: " + scene.title, options.width, options.height);
  CameraHand camera(scene.render ? scene.render->camera : Camera::kReview);
  LiveControls live = controls_of(scene, by_mouse);

  part.folder.emplace(
      ResultsPlace{options.folder, folder_of_scene(options.file, "_view"), options.force});
  const std::string folder = part.folder->path();
  open_log(part.folder->at());
  log_loading(scene, loaded, cache);
  part.simulation = std::move(loaded.simulation);
  part.session.goal = std::move(loaded.goal);
  part.session.input = loaded.notes.input;
  part.loading = std::move(loaded.loading);
  const auto longest = static_cast<std::uint64_t>(kLongestLiveRun_s * scene.haptics.rate_hz);
  std::unique_ptr<SceneDevice> device;
  if (!by_mouse) {
    device = std::make_unique<SceneDevice>(scene, trajectory, longest, std::move(plugin));
  }
  Holder holder(scene, std::move(device));
  const EndsItself stopped_by_itself;
  for (int number = 2;; ++number) {
    part.session.pace = Pace::kReal;
    part.session.stream = stream;
    part.session.render = false;
    part.session.ticks = longest;
    const std::size_t burr = live.burr;
    take_burr(part.simulation->scene(), live);
    holder.begin(part, burr);
    std::optional<GoOn> go_on = PartInWindow(part, holder, window, camera, live).run();
    if (!go_on || !window.is_open() || stop_requested()) break;
    if (live.burr != burr) {
      go_on->overrides.insert(go_on->overrides.begin(), scene.burrs[live.burr].as_override);
    }
    const bool goes_back = std::isfinite(go_on->at_s);
    if (live.burr != burr) {
      live.said = live.burrs[live.burr];
    } else if (goes_back) {
      live.said = formatted("goes on from %.3f s", go_on->at_s);
    }
    std::string refused;
    part =
        part_after(part.recording(), *go_on, folder + "/part_" + std::to_string(number), refused);
    if (!refused.empty()) {  // on with the one before
      live.said = refused;
      live.burr = burr;
    }
    if (live.burr == burr && goes_back) live.paused = true;  // until the user takes it up again
    live.other_burr = false;                                 // it is this part's own now
    open_log(part.folder->at());
  }
  holder.end();
}

}  // namespace sulcus
