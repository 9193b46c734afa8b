#include <cmath>
#include <filesystem>
#include <memory>

#include <spdlog/spdlog.h>

#include "app/commands.hpp"
#include "app/results.hpp"
#include "app/simulation.hpp"
#include "app/thread_limit.hpp"
#include "engine/cache/load_cache.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/import/load_burr.hpp"
#include "engine/outcome/goal.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/simulated_device.hpp"

namespace sulcus {

namespace {

struct RunOptions {
  std::string scene, folder, pace = "fast";
  double duration_s = 0.0;  // 0: the whole trajectory
  std::vector<std::string> overrides;
  bool no_render = false, no_cache = false;
  int threads = 0;  // 0: all cores
  double limit_gib = 4.0;
};

double seconds_since(std::uint64_t begin_ns) {
  return 1e-9 * static_cast<double>(steady_ns() - begin_ns);
}

void run(const RunOptions& options) {
  const ThreadLimit limit(options.threads);
  // All input is read before anything is written.
  const InputLimits limits{
      .memory_bytes = static_cast<std::uint64_t>(options.limit_gib * InputLimits::kGibibyte)};
  const Scene scene = load_scene(options.scene, options.overrides, limits);
  const Trajectory trajectory = make_trajectory(scene.trajectory, limits);
  LoadCache cache = options.no_cache ? LoadCache() : LoadCache::of_user();
  std::vector<PartUse> loading;
  std::uint64_t begin = steady_ns();
  Burr burr = load_burr(scene, &cache);
  const bool burr_cached = cache.hits() > 0;
  loading.push_back({"burr", seconds_since(begin), burr.field.memory_bytes(), burr_cached});
  begin = steady_ns();
  VoxelModel model = build_workpiece(scene, &cache);
  const bool workpiece_cached = cache.hits() > (burr_cached ? 1 : 0);
  double workpiece_s = seconds_since(begin);
  const auto hits = cache.hits();
  begin = steady_ns();
  std::vector<VoxelModel> bodies = build_bodies(scene, &cache);
  double bodies_s = seconds_since(begin);
  const bool bodies_cached = cache.hits() == hits + static_cast<int>(bodies.size());
  check_start(scene, model, bodies, burr, trajectory.pose_at(0.0));
  std::optional<VoxelModel> goal = build_goal(scene, &cache);
  (void)target_of_goal(scene, model, goal ? &*goal : nullptr);  // refuses what it cannot be
  std::vector<std::pair<std::string, const WorkpieceSettings*>> clipped;
  if (model.clipped) clipped.emplace_back("the solid", &scene.workpiece);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].clipped) clipped.emplace_back(scene.bodies[i].name, &scene.bodies[i].solid);
  }
  begin = steady_ns();
  std::vector<Neighbour> neighbours = make_neighbours(scene, std::move(bodies));
  bodies_s += seconds_since(begin);
  begin = steady_ns();
  Simulation simulation(scene, std::move(model), std::move(neighbours), std::move(burr),
                        StageClock(steady_ns));
  workpiece_s += seconds_since(begin);
  loading.push_back(
      {"workpiece", workpiece_s, simulation.workpiece().memory_bytes(), workpiece_cached});
  if (!scene.bodies.empty()) {
    loading.push_back({"bodies", bodies_s, simulation.neighbours_bytes(), bodies_cached});
  }

  SessionOptions session;
  session.folder = options.folder.empty()
                       ? "out/" + std::filesystem::path(options.scene).stem().string()
                       : options.folder;
  session.pace = options.pace == "real" ? Pace::kReal : Pace::kFast;
  session.render = !options.no_render;
  session.goal = std::move(goal);
  const double duration_s = options.duration_s > 0.0 ? options.duration_s : trajectory.duration_s();
  session.ticks = static_cast<std::uint64_t>(
      std::max(1.0, std::ceil(duration_s * scene.haptics.rate_hz - 1e-6)));

  open_log(session.folder);
  if (!cache.note().empty()) spdlog::info("{}", cache.note());
  for (const auto& [name, solid] : clipped) {
    spdlog::warn(
        "{} reaches beyond the grid of {} x {} x {} voxels of {} mm and is cut flat at its faces",
        name, solid->cells.x(), solid->cells.y(), solid->cells.z(), solid->voxel_m / kMillimetre);
  }
  if (const HapticsSettings& h = scene.haptics; h.normal_error_deg) {
    spdlog::info("normal_error_deg = {}: normals by {}, neighbourhood {}, trace {}",
                 *h.normal_error_deg, kNormalMethodNames[static_cast<std::size_t>(h.normals)],
                 h.neighbourhood, h.trace);
  }
  ScriptedDevice script(trajectory, scene.haptics.rate_hz);
  std::optional<SimulatedDevice> simulated;
  if (scene.device) {
    simulated.emplace(*scene.device, trajectory, scene.haptics.rate_hz, scene.burr.reference_m);
  }
  Device& device = simulated ? static_cast<Device&>(*simulated) : script;
  const SessionResult result = run_session(simulation, device, session);
  write_results(simulation, result, session, loading);
}

}  // namespace

void add_run_command(CLI::App& program) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = program.add_subcommand("run", "Run a scene");
  command->add_option("SCENE", options->scene, "Scene file, .toml")->required();
  command->add_option("-o", options->folder, "Folder for the results (out/<scene>)");
  command->add_option("--pace", options->pace, "real: 1 tick each 1 / rate_hz; fast: no waiting")
      ->check(CLI::IsMember({"real", "fast"}));
  command->add_option("--duration", options->duration_s, "Seconds of the run's time to simulate")
      ->check(CLI::Range(1e-6, 1e6));
  // One value a time: without this the option would swallow what follows it.
  command->add_option("--set", options->overrides, "TABLE.KEY=VALUE, changes the scene; repeatable")
      ->expected(1)
      ->take_all();
  command->add_flag("--no-render", options->no_render, "Draw nothing, whatever the scene says");
  command->add_flag("--no-cache", options->no_cache, "Make all anew, and keep nothing of it");
  add_threads_option(*command, options->threads);
  command
      ->add_option("--limit-gib", options->limit_gib,
                   "GiB that the contents of a volume, mesh or pose table may take once read (4)")
      ->check(CLI::Range(1e-3, 1024.0));
  command->callback([options] { run(*options); });
}

}  // namespace sulcus
