#include "app/session/simulation.hpp"

#include <algorithm>
#include <utility>

#include "haptics/move_tool.hpp"
#include "haptics/way_through.hpp"

namespace sulcus {

namespace {

std::vector<Workpiece> workpieces(VoxelModel start, std::vector<VoxelModel> others) {
  std::vector<Workpiece> all;
  all.reserve(1 + others.size());
  all.emplace_back(std::move(start));
  for (VoxelModel& other : others) all.emplace_back(std::move(other));
  return all;
}

}  // namespace

Simulation::Simulation(const Scene& scene, VoxelModel start, std::vector<VoxelModel> others,
                       Burr burr, StageClock clock, const Pose& first)
    : scene_(scene),
      burr_(std::move(burr)),
      state_(initial_state(scene_, workpieces(std::move(start), std::move(others)), first)),
      scratch_(scene_, clock),
      context_{scene_, burr_} {}

bool Simulation::is_free(const Pose& tool) const noexcept {
  return std::ranges::none_of(state_.bodies, [&](const Body& body) {
    return is_inside(body.solid.model(), body.world_from_grid, middle_of_head(burr_, tool));
  });
}

std::vector<VoxelModel> Simulation::other_bodies() const {
  std::vector<VoxelModel> bodies;
  for (const Body& body : state_.others()) bodies.push_back(body.solid.model());
  return bodies;
}

std::size_t Simulation::contact_bytes() const {
  std::size_t bytes = scratch_.contact_bytes();
  for (const Body& body : state_.bodies)
    bytes += body.normal_cache ? body.normal_cache->memory_bytes() : 0;
  return bytes;
}

std::size_t Simulation::cutting_bytes() const {
  if (!scene_.cutting) return 0;
  std::size_t bytes = scratch_.edits.capacity() * sizeof(Edit);
  for (const Body& body : state_.bodies) {
    bytes += body.removal ? body.removal->part_cut.memory_bytes() : 0;
  }
  return bytes;
}

std::size_t Simulation::others_bytes() const {
  std::size_t bytes = 0;
  for (const Body& body : state_.others()) bytes += body.solid.memory_bytes();
  return bytes;
}

}  // namespace sulcus
