#include <memory>
#include <optional>
#include <utility>

#include <spdlog/spdlog.h>

#include "app/commands/common_options.hpp"
#include "app/commands/shipped_files.hpp"
#include "app/live/live_device.hpp"
#include "app/live/live_part.hpp"
#include "app/live/scene_device.hpp"
#include "app/playback/scene_trajectory.hpp"
#include "app/report/log_file.hpp"
#include "app/report/output_file.hpp"
#include "app/report/results.hpp"
#include "app/report/run_key.hpp"
#include "app/session/loaded_run.hpp"
#include "app/stream/stream_port.hpp"
#include "app/terminal/progress.hpp"
#include "engine/cache/load_cache.hpp"
#include "engine/core/error.hpp"
#include "engine/core/stop.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

namespace {

struct RunOptions {
  std::string scene, folder, pace = "fast", plugins;
  double duration_s = 0.0;  // 0: the whole trajectory
  std::vector<std::string> overrides;
  bool no_render = false, no_cache = false, force = false;
  int threads = 0;  // 0: all cores
  double limit_gib = 4.0;
};

/// What a run whose burr is changed goes on from is its recording.
void check_spare_burrs(const Scene& scene) {
  if (scene.burrs.empty() || scene.record) return;
  throw InputError(scene.file, "spare_burr", "a burr to change to without [record]",
                   "both of them");
}

/// Runs with the device of a plug-in, and goes on with each other burr that it asks for.
void run_with_plugin(LivePart part, const Scene& scene, SceneDevice& held) {
  PluginDevice& plugin = *held.plugin();
  LiveDevice device(plugin, scene.haptics.rate_hz, true, false, scene.burrs.size());
  plugin.begin([&](const Pose& pose) { return part.simulation->is_free(pose); });
  const std::uint64_t last = part.session.ticks;
  const Pace pace = part.session.pace;
  const bool render = part.session.render;
  const std::shared_ptr<StreamPort> stream = part.session.stream;
  const std::string folder = part.folder->path();
  std::uint32_t has = 0;  // burr that is in
  for (int number = 2;; ++number) {
    run_into(*part.folder, *part.simulation, device, part.session, part.loading);
    const std::uint32_t burr = device.wanted_burr();
    if (!device.goes_on() || burr == kSameBurr || part.simulation->state().tick >= last) {
      break;
    }
    std::string refused;
    part = part_after(part.recording(), {.overrides = {scene.burrs[burr].as_override}},
                      folder + "/part_" + std::to_string(number), refused);
    open_log(part.folder->at());
    if (refused.empty()) {
      has = burr;
    } else {
      spdlog::warn("the burr is not changed: {}", refused);
    }
    part.session.pace = pace;
    part.session.render = render;
    part.session.stream = stream;
    part.session.ticks = last - part.simulation->state().tick;
    device.begin_part(true, has);
    plugin.go_on([&](const Pose& pose) { return part.simulation->is_free(pose); });
  }
  device.finish();
  held.end();
}

void run(const RunOptions& options) {
  const ThreadLimit limit(options.threads);
  check_output_folder("-o", options.folder);
  // All input is read before anything is written.
  const InputLimits limits{
      .memory_bytes = static_cast<std::uint64_t>(options.limit_gib * InputLimits::kGibibyte)};
  const std::string file = scene_to_run(options.scene);
  Scene scene = load_scene(file, options.overrides, limits);
  const Trajectory trajectory = scene_trajectory(scene, limits);
  std::unique_ptr<PluginDevice> plugin =
      open_plugin(plugin_folders(options.plugins), options.pace == "real", trajectory, scene);
  if (plugin) check_spare_burrs(scene);
  std::shared_ptr<StreamPort> stream;  // who connects while it loads has the first tick
  if (scene.stream) stream = std::make_shared<StreamPort>(scene);
  LoadCache cache = options.no_cache ? LoadCache() : LoadCache::of_user();
  std::optional<Progress> loading(std::in_place, "loading");
  LoadedRun loaded = load_run(scene, trajectory.pose_at(0.0), cache);
  loading.reset();

  LivePart part;
  SessionOptions& session = part.session;
  session.stream = std::move(stream);
  session.pace = options.pace == "real" ? Pace::kReal : Pace::kFast;
  session.render = !options.no_render;
  session.goal = std::move(loaded.goal);
  session.input = loaded.notes.input;
  double duration_s = options.duration_s;
  if (duration_s <= 0.0) {
    duration_s = plugin && plugin->is_live() ? kLongestLiveRun_s : trajectory.duration_s();
  }
  session.ticks = ticks_in(duration_s, scene.haptics.rate_hz);

  ResultsPlace place{options.folder, folder_of_scene(file), options.force};
  if (!plugin) {  // a hand does not do the same again
    place.key = key_of_run(*loaded.simulation, session.goal ? &*session.goal : nullptr,
                           session.ticks, scene.render && session.render);
  }
  part.folder.emplace(place);
  open_log(part.folder->at());
  log_loading(scene, loaded, cache);
  if (const double clock_s = trajectory.clock_at_start_s(); clock_s != 0.0) {
    spdlog::warn("{}: its first pose is at {} s, which is 0 s of the run", scene.trajectory.file,
                 clock_s);
  }
  part.simulation = std::move(loaded.simulation);
  part.loading = std::move(loaded.loading);
  SceneDevice held(scene, trajectory, session.ticks, std::move(plugin));
  std::optional<EndsItself> ends_itself;  // before the first tick there is nothing to keep
  session.begins = [&] { ends_itself.emplace(); };
  if (held.plugin()) {
    run_with_plugin(std::move(part), scene, held);
  } else {
    run_into(*part.folder, *part.simulation, held.device(), session, part.loading);
  }
}

}  // namespace

void add_run_command(CLI::App& program) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = program.add_subcommand("run", "Run a scene");
  add_option(*command, "SCENE", options->scene, "FILE", kSceneArgument)->required();
  add_folder_options(*command, options->folder, options->force, "out/<scene>");
  add_pace_option(*command, options->pace);
  add_option(
      *command, "--duration", options->duration_s, "S",
      "Seconds of the run's time to simulate (all of the trajectory; with a device that lives in "
      "real time until it is over)")
      ->check(number_within(1e-6, 1e6));
  add_set_option(*command, options->overrides, "Change a key of the scene; repeatable");
  add_option(*command, "--plugins", options->plugins, "DIR",
             "Folder in which the scene's device plug-in is looked for first (the installed one)")
      ->check(CLI::ExistingDirectory);
  command->add_flag("--no-render", options->no_render, "Draw nothing, whatever the scene says");
  command->add_flag("--no-cache", options->no_cache, "Make all anew, and keep nothing of it");
  add_threads_option(*command, options->threads);
  add_option(*command, "--limit-gib", options->limit_gib, "GIB",
             "GiB that the contents of a volume, mesh or pose table may take once read (4)")
      ->check(number_within(1e-3, 1024.0));
  command->callback([options] { run(*options); });
}

}  // namespace sulcus
