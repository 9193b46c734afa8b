#include "haptics/simulation_state.hpp"

#include <algorithm>
#include <array>

#include "engine/core/hash.hpp"
#include "engine/normals/normal_method.hpp"

namespace sulcus {

SimulationState initial_state(const Scene& scene, const VoxelGrid& grid) {
  SimulationState state;
  if (scene.cutting) state.removal.emplace(*scene.cutting);
  if (scene.haptics.keep_normals && use_tool(scene.haptics.normals)) {
    state.kept.emplace(grid, scene.haptics);
  }
  if (scene.spindle) state.spindle_rad_per_s = scene.burr.speed_rad_per_s;
  if (scene.trajectory.load_N) state.load_offset_m = 0.0;
  return state;
}

std::uint64_t SimulationState::hash() const {
  std::array<double, 14> values{};
  std::copy_n(tool.position.data(), 3, values.begin());
  std::copy_n(tool.orientation.coeffs().data(), 4, values.begin() + 3);
  values[10] = has_pose ? 1.0 : 0.0;
  values[11] = spindle_rad_per_s.value_or(0.0);
  values[12] = load_offset_m.value_or(0.0);
  if (removal) {
    values[7] = removal->pool_J;
    values[8] = removal->work_J;
    values[9] = removal->removed_J;
    values[13] = removal->carried_J;
  }
  const std::uint64_t seed =
      tick ^ (removal ? removal->part_cut.hash() : 0) ^ (kept ? kept->hash() : 0);
  return hash_bytes(values.data(), sizeof(values), seed);
}

}  // namespace sulcus
