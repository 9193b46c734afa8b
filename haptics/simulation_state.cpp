#include "haptics/simulation_state.hpp"

#include <utility>

#include "engine/core/hash.hpp"
#include "haptics/state_fields.hpp"

namespace sulcus {

SimulationState initial_state(const Scene& scene, std::vector<Workpiece> starts,
                              const Pose& start) {
  SimulationState state;
  state.tool = state.port.pose = start;
  if (scene.spindle) state.spindle_rad_per_s = scene.burr.speed_rad_per_s;
  if (scene.trajectory.load_N) state.load_offset_m = 0.0;
  state.bodies = make_bodies(scene, std::move(starts));
  return state;
}

std::uint64_t SimulationState::hash() const {
  std::uint64_t hash = fields::hash_of([this](auto& archive) { fields::head(archive, *this); });
  const auto add = [&](std::uint64_t part) { hash = hash_bytes(&part, sizeof(part), hash); };
  if (workpiece().removal) add(workpiece().removal->hash());
  for (const Body& body : others()) add(body.hash());
  return hash;
}

double SimulationState::work_J() const {
  double work_J = 0.0;
  for (const Body& body : bodies) work_J += body.removal ? body.removal->work_J : 0.0;
  return work_J;
}

}  // namespace sulcus
