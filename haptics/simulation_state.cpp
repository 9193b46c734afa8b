#include "haptics/simulation_state.hpp"

#include "engine/core/hash.hpp"
#include "haptics/state_fields.hpp"

namespace sulcus {

SimulationState initial_state(const Scene& scene, const VoxelGrid& grid, const Pose& start) {
  SimulationState state;
  state.tool = state.port.pose = start;
  if (scene.cutting) state.removal.emplace(*scene.cutting);
  if (keeps_normals(scene.haptics)) state.kept.emplace(grid, scene.haptics);
  if (scene.spindle) state.spindle_rad_per_s = scene.burr.speed_rad_per_s;
  if (scene.trajectory.load_N) state.load_offset_m = 0.0;
  return state;
}

std::uint64_t SimulationState::hash() const {
  std::uint64_t hash = fields::hash_of([this](auto& archive) { fields::head(archive, *this); });
  const auto add = [&](std::uint64_t part) { hash = hash_bytes(&part, sizeof(part), hash); };
  if (removal) add(removal->hash());
  if (kept) add(kept->hash());
  for (const Neighbour& neighbour : neighbours) add(neighbour.hash());
  return hash;
}

double SimulationState::work_J() const {
  double work_J = removal ? removal->work_J : 0.0;
  for (const Neighbour& neighbour : neighbours) {
    if (neighbour.removal) work_J += neighbour.removal->work_J;
  }
  return work_J;
}

}  // namespace sulcus
