#include "app/session/loaded_run.hpp"

#include <spdlog/spdlog.h>

#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/import/load_burr.hpp"
#include "engine/outcome/goal.hpp"

namespace sulcus {

namespace {

/// What is tested are surface voxels' centres: a burr fits between those that are as far apart as
/// it is thick.
void warn_of_coarse_voxels(const std::string& name, const WorkpieceSettings& solid,
                           const Burr& burr) {
  constexpr double kFewest = 2.0;  // across the burr
  const double width_m = 2.0 * burr.capsule.radius_m;
  if (width_m >= kFewest * solid.voxel_m) return;
  spdlog::warn(
      "{} has voxels of {} mm, too coarse for a burr of {:.3g} mm, which may touch nothing", name,
      solid.voxel_m / kMillimetre, width_m / kMillimetre);
}

}  // namespace

LoadedRun load_run(const Scene& scene, const Pose& start, LoadCache& cache) {
  LoadedRun run;
  std::uint64_t begin = steady_ns();
  Burr burr = load_burr(scene, &cache);
  const bool burr_cached = cache.hits() > 0;
  run.loading.push_back({"burr", seconds_since(begin), burr.field.memory_bytes(), burr_cached});
  begin = steady_ns();
  VoxelModel model = build_workpiece(scene, &cache, &run.notes);
  const bool workpiece_cached = cache.hits() > (burr_cached ? 1 : 0);
  double workpiece_s = seconds_since(begin);
  const auto hits = cache.hits();
  begin = steady_ns();
  std::vector<VoxelModel> bodies = build_bodies(scene, &cache, &run.warnings_beside);
  double bodies_s = seconds_since(begin);
  const bool bodies_cached = cache.hits() == hits + static_cast<int>(bodies.size());
  check_start(scene, model, bodies, burr, start);
  run.goal = build_goal(scene, &cache, &run.warnings_beside);
  (void)target_of_goal(scene, model, run.goal ? &*run.goal : nullptr);  // refuses what cannot be
  if (model.clipped) run.clipped.emplace_back("the solid", &scene.workpiece);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].clipped) run.clipped.emplace_back(scene.bodies[i].name, &scene.bodies[i].solid);
  }
  begin = steady_ns();
  run.simulation = std::make_unique<Simulation>(scene, std::move(model), std::move(bodies),
                                                std::move(burr), StageClock(steady_ns), start);
  workpiece_s += seconds_since(begin);
  run.loading.push_back(
      {"workpiece", workpiece_s, run.simulation->workpiece().memory_bytes(), workpiece_cached});
  if (!scene.bodies.empty()) {
    run.loading.push_back({"bodies", bodies_s, run.simulation->others_bytes(), bodies_cached});
  }
  return run;
}

void log_loading(const Scene& scene, const LoadedRun& run, const LoadCache& cache) {
  if (!cache.note().empty()) spdlog::info("{}", cache.note());
  for (const std::string& warning : run.notes.warnings) {
    spdlog::warn("{}: {}", scene.workpiece.shape ? scene.file : scene.workpiece.file, warning);
  }
  for (const std::string& warning : run.warnings_beside) {
    spdlog::warn("{}: {}", scene.file, warning);
  }
  for (const auto& [name, solid] : run.clipped) {
    // Who asks for a built-in shape in a grid that it does not fit into wants that part of it.
    spdlog::log(
        solid->shape ? spdlog::level::info : spdlog::level::warn,
        "{} reaches beyond the grid of {} x {} x {} voxels of {} mm and is cut flat at its faces",
        name, solid->cells.x(), solid->cells.y(), solid->cells.z(), solid->voxel_m / kMillimetre);
  }
  warn_of_coarse_voxels("the solid", scene.workpiece, run.simulation->burr());
  for (const BodySettings& body : scene.bodies) {
    warn_of_coarse_voxels(body.name, body.solid, run.simulation->burr());
  }
  if (const HapticsSettings& h = scene.haptics; h.normal_error_deg) {
    spdlog::info("normal_error_deg = {}: normals by {}, neighbourhood {}, trace {}",
                 *h.normal_error_deg, kNormalMethodNames[static_cast<std::size_t>(h.normals)],
                 h.neighbourhood, h.trace);
  }
}

}  // namespace sulcus
