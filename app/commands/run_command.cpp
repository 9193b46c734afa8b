#include <memory>
#include <optional>
#include <utility>

#include <spdlog/spdlog.h>

#include "app/commands/common_options.hpp"
#include "app/commands/shipped_files.hpp"
#include "app/playback/scene_trajectory.hpp"
#include "app/report/log_file.hpp"
#include "app/report/output_file.hpp"
#include "app/report/results.hpp"
#include "app/report/run_key.hpp"
#include "app/session/loaded_run.hpp"
#include "app/session/plugin_device.hpp"
#include "app/session/plugin_library.hpp"
#include "app/terminal/progress.hpp"
#include "engine/cache/load_cache.hpp"
#include "engine/core/error.hpp"
#include "engine/core/stop.hpp"
#include "engine/scene/scene_file.hpp"
#include "haptics/device/simulated_device.hpp"

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

/// Opens the plug-in that a scene names; the scene then says the limits of the device, so that it
/// replays without the plug-in. Null where it names none.
std::unique_ptr<PluginDevice> open_plugin(const std::string& file, const RunOptions& options,
                                          const InputLimits& limits, const Trajectory& trajectory,
                                          Scene& scene) {
  if (!scene.device || !scene.device->plugin) return nullptr;
  auto device = std::make_unique<PluginDevice>(scene, trajectory, plugin_folders(options.plugins),
                                               options.pace == "real");
  std::vector<std::string> overrides = options.overrides;
  for (std::string& limit : device->limits_as_overrides()) overrides.push_back(std::move(limit));
  scene = load_scene(file, overrides, limits);
  return device;
}

/// Says what there is to say of how it went. Throws where the device ended the run.
void end_plugin(PluginDevice& device) {
  try {
    for (const std::string& line : device.end()) spdlog::warn("{}", line);
  } catch (const std::exception& why) {  // the terminal gets it from where it is caught
    spdlog::info("{}", why.what());
    throw;
  }
  spdlog::info("{}: its longest call took {:.3f} ms", device.title(), device.longest_call_ms());
}

void run(const RunOptions& options) {
  const ThreadLimit limit(options.threads);
  check_output_folder("-o", options.folder);
  // All input is read before anything is written.
  const InputLimits limits{
      .memory_bytes = static_cast<std::uint64_t>(options.limit_gib * InputLimits::kGibibyte)};
  const std::string file = scene_file_of(options.scene);
  Scene scene = load_scene(file, options.overrides, limits);
  const Trajectory trajectory = scene_trajectory(scene, limits);
  const std::unique_ptr<PluginDevice> plugin =
      open_plugin(file, options, limits, trajectory, scene);
  LoadCache cache = options.no_cache ? LoadCache() : LoadCache::of_user();
  std::optional<Progress> loading(std::in_place, "loading");
  LoadedRun loaded = load_run(scene, trajectory.pose_at(0.0), cache);
  loading.reset();

  SessionOptions session;
  session.pace = options.pace == "real" ? Pace::kReal : Pace::kFast;
  session.render = !options.no_render;
  session.goal = std::move(loaded.goal);
  session.input = loaded.notes.input;
  const double duration_s = options.duration_s > 0.0 ? options.duration_s : trajectory.duration_s();
  session.ticks = ticks_in(duration_s, scene.haptics.rate_hz);

  ResultsPlace place{options.folder, folder_of_scene(file), options.force};
  if (!plugin) {  // a hand does not do the same again
    place.key = key_of_run(*loaded.simulation, session.goal ? &*session.goal : nullptr,
                           session.ticks, scene.render && session.render);
  }
  ResultsFolder folder(place);
  open_log(folder.at());
  log_loading(scene, loaded, cache);
  ScriptedDevice script(trajectory, scene.haptics.rate_hz);
  const std::vector<std::optional<Pose>> poses =
      played_back_poses(scene, trajectory, session.ticks);
  std::optional<PlaybackDevice> playback;
  std::optional<SimulatedDevice> simulated;
  Device* device = &script;
  if (plugin) {
    device = plugin.get();
    spdlog::info("{}: {}", plugin->title(), plugin->own_name());
    plugin->begin([&](const Pose& pose) { return loaded.simulation->is_free(pose); });
  } else if (!poses.empty()) {
    device = &playback.emplace(poses);
  } else if (scene.device && !scene.device->played_back) {
    device = &simulated.emplace(*scene.device, trajectory, scene.haptics.rate_hz,
                                scene.burr.reference_m);
  }
  std::optional<EndsItself> ends_itself;  // before the first tick there is nothing to keep
  session.begins = [&] { ends_itself.emplace(); };
  run_into(folder, *loaded.simulation, *device, session, loaded.loading);
  if (plugin) end_plugin(*plugin);
}

}  // namespace

void add_run_command(CLI::App& program) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = program.add_subcommand("run", "Run a scene");
  add_option(*command, "SCENE", options->scene, "FILE", kSceneArgument)->required();
  add_folder_options(*command, options->folder, options->force, "out/<scene>");
  add_pace_option(*command, options->pace);
  add_option(*command, "--duration", options->duration_s, "S",
             "Seconds of the run's time to simulate (all of the trajectory)")
      ->check(CLI::Range(1e-6, 1e6));
  add_set_option(*command, options->overrides, "Change a key of the scene; repeatable");
  add_option(*command, "--plugins", options->plugins, "DIR",
             "Folder in which the scene's device plug-in is looked for first (the installed one)")
      ->check(CLI::ExistingDirectory);
  command->add_flag("--no-render", options->no_render, "Draw nothing, whatever the scene says");
  command->add_flag("--no-cache", options->no_cache, "Make all anew, and keep nothing of it");
  add_threads_option(*command, options->threads);
  add_option(*command, "--limit-gib", options->limit_gib, "GIB",
             "GiB that the contents of a volume, mesh or pose table may take once read (4)")
      ->check(CLI::Range(1e-3, 1024.0));
  command->callback([options] { run(*options); });
}

}  // namespace sulcus
