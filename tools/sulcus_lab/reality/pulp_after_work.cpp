#include "tools/sulcus_lab/reality/pulp_after_work.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "app/session/simulation.hpp"
#include "engine/heat/heat_log.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/shapes/build_shape.hpp"
#include "engine/tool/burr.hpp"
#include "haptics/device/device.hpp"

namespace sulcus::lab {

PulpHeat pulp_after_work(const std::string& scene_file, const std::vector<std::string>& overrides) {
  const Scene scene = load_scene(scene_file, overrides);
  if (!scene.heat) throw std::invalid_argument(scene_file + " has no heat");
  VoxelModel tooth = build_shape(scene);
  ToothHeat heat(scene, tooth);
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
  heat.advance(log, std::numeric_limits<double>::infinity());
  if (!heat.result().pulp) throw std::invalid_argument(scene_file + ": its tooth has no pulp");
  return *heat.result().pulp;
}

PulpFigures pulp_after_a_minute(const std::vector<std::string>& overrides) {
  const auto change_K = [&](const char* water) {
    std::vector<std::string> all = overrides;
    all.emplace_back(water);
    return pulp_after_work(SULCUS_SCENES "/occlusal_minute.toml", all).end_change_K();
  };
  return {change_K("heat.water_ml_min=0"), change_K("heat.water_ml_min=30")};
}

}  // namespace sulcus::lab
