#include "tools/sulcus_lab/reality/pulp_after_a_minute.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "app/session/simulation.hpp"
#include "engine/core/units.hpp"
#include "engine/heat/heat_log.hpp"
#include "engine/heat/tooth_heat.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/shapes/build_shape.hpp"
#include "engine/tool/burr.hpp"
#include "haptics/device/device.hpp"

namespace sulcus::lab {

namespace {

/// What a scene's ticks do, the scripted burr following the trajectory.
HeatLog worked(const Scene& scene, VoxelModel tooth) {
  const Trajectory trajectory = make_trajectory(scene.trajectory);
  Simulation simulation(scene, std::move(tooth), {},
                        make_burr(scene.burr, scene.workpiece.voxel_m, scene.file), StageClock{},
                        trajectory.pose_at(0.0));
  ScriptedDevice device(trajectory, scene.haptics.rate_hz);
  HeatLog log(scene.haptics.rate_hz, 0);
  const auto ticks =
      static_cast<std::uint64_t>(std::ceil(trajectory.duration_s() * scene.haptics.rate_hz - 1e-6));
  for (std::uint64_t i = 0; i < ticks; ++i) {
    const TickRecord record = simulation.step(device);
    log.add(record, simulation.cutting());
    for (const Edit& edit : simulation.edits()) log.add(edit);
  }
  return log;
}

}  // namespace

PulpFigures pulp_after_a_minute(const std::vector<std::string>& overrides) {
  Scene scene = load_scene(SULCUS_SCENES "/occlusal_minute.toml", overrides);
  const VoxelModel tooth = build_shape(scene);
  const HeatLog log = worked(scene, VoxelModel(tooth));
  const auto change_K = [&](double water_ml_min) {
    scene.heat.value().water_m3_per_s = water_ml_min * kMillilitrePerMinute;
    ToothHeat heat(scene, tooth);
    heat.advance(log, std::numeric_limits<double>::infinity());
    return heat.result().pulp.value().end_change_K();
  };
  return {change_K(0.0), change_K(30.0)};
}

}  // namespace sulcus::lab
