#include "app/session/simulation.hpp"

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "haptics/move_tool.hpp"
#include "haptics/way_through.hpp"

namespace sulcus {

namespace {

Eigen::AlignedBox3d box_of(const VoxelGrid& grid, double margin_m = 0.0) {
  const Eigen::Vector3d half = (0.5 * grid.voxel_m * grid.cells.cast<double>()).array() + margin_m;
  return {-half, half};
}

/// The bodies' grids as boxes, in world axes. The tick asks for what is within a voxel of the
/// workpiece's; the others' own may be larger.
std::vector<Eigen::AlignedBox3d> body_boxes(const VoxelGrid& grid,
                                            std::span<const Neighbour> neighbours) {
  std::vector<Eigen::AlignedBox3d> boxes{box_of(grid)};
  for (const Neighbour& neighbour : neighbours) {
    const VoxelGrid& own = neighbour.solid.grid();
    const Eigen::Isometry3d world_from_grid =
        Eigen::Translation3d(neighbour.world_from_grid.position) *
        neighbour.world_from_grid.orientation;
    boxes.push_back(box_of(own, own.voxel_m).transformed(world_from_grid));
  }
  return boxes;
}

SimulationState state_with_neighbours(const Scene& scene, const VoxelGrid& grid,
                                      std::vector<Neighbour> neighbours, const Pose& first) {
  SimulationState state = initial_state(scene, grid, first);
  state.neighbours = std::move(neighbours);
  return state;
}

}  // namespace

Simulation::Simulation(const Scene& scene, VoxelModel start, std::vector<Neighbour> neighbours,
                       Burr burr, StageClock clock, const Pose& first)
    : scene_(scene),
      workpiece_(std::move(start)),
      burr_(std::move(burr)),
      state_(state_with_neighbours(scene_, workpiece_.grid(), std::move(neighbours), first)),
      bodies_(body_boxes(workpiece_.grid(), state_.neighbours)),
      scratch_(scene_, clock),
      context_{scene_, burr_, bodies_.query()} {}

bool Simulation::is_free(const Pose& tool) const noexcept {
  if (is_inside(workpiece_.model(), {}, middle_of_head(burr_, tool))) return false;
  return std::ranges::none_of(state_.neighbours, [&](const Neighbour& n) {
    return is_inside(n.solid.model(), n.world_from_grid, middle_of_head(burr_, tool));
  });
}

std::vector<VoxelModel> Simulation::other_bodies() const {
  std::vector<VoxelModel> bodies;
  for (const Neighbour& neighbour : state_.neighbours) bodies.push_back(neighbour.solid.model());
  return bodies;
}

std::size_t Simulation::contact_bytes() const {
  std::size_t bytes = scratch_.contact_bytes() + (state_.kept ? state_.kept->memory_bytes() : 0);
  for (const Neighbour& neighbour : state_.neighbours) {
    if (neighbour.kept) bytes += neighbour.kept->memory_bytes();
  }
  return bytes;
}

std::size_t Simulation::cutting_bytes() const {
  if (!state_.removal) return 0;
  std::size_t bytes = state_.removal->part_cut.memory_bytes();
  for (const Neighbour& neighbour : state_.neighbours) {
    if (neighbour.removal) bytes += neighbour.removal->part_cut.memory_bytes();
  }
  return bytes + scratch_.edits.capacity() * sizeof(Edit);
}

std::size_t Simulation::neighbours_bytes() const {
  std::size_t bytes = 0;
  for (const Neighbour& neighbour : state_.neighbours) bytes += neighbour.solid.memory_bytes();
  return bytes;
}

void check_start(const Scene& scene, const VoxelModel& model, std::span<const VoxelModel> bodies,
                 const Burr& burr, const Pose& start) {
  const Eigen::Vector3d middle = middle_of_head(burr, start);
  const auto check = [&](const VoxelModel& solid, const Pose& world_from_grid,
                         const std::string& name) {
    if (!is_inside(solid, world_from_grid, middle)) return;
    std::ostringstream found;
    found << "a start with the burr's head inside " << name << ", at ("
          << (middle / kMillimetre).transpose() << ") mm";
    throw InputError(scene.file, "[trajectory]", found.str(), "a start outside it");
  };
  check(model, {}, "the tooth");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    check(bodies[i], scene.bodies[i].world_from_grid, "'" + scene.bodies[i].name + "'");
  }
}

}  // namespace sulcus
