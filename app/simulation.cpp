#include "app/simulation.hpp"

#include <array>
#include <sstream>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

/// The grid as a box: all of the workpiece is in it.
std::array<Eigen::AlignedBox3d, 1> body_boxes(const VoxelGrid& grid) {
  const Eigen::Vector3d half = 0.5 * grid.voxel_m * grid.cells.cast<double>();
  return {Eigen::AlignedBox3d(-half, half)};
}

}  // namespace

Simulation::Simulation(const Scene& scene, VoxelModel start, Burr burr, StageClock clock)
    : scene_(scene),
      workpiece_(std::move(start)),
      burr_(std::move(burr)),
      bodies_(body_boxes(workpiece_.grid())),
      state_(initial_state(scene_, workpiece_.grid())),
      scratch_(scene_, clock),
      context_{scene_, burr_, bodies_.query()} {}

std::size_t Simulation::cutting_bytes() const {
  if (!state_.removal) return 0;
  return state_.removal->part_cut.memory_bytes() + scratch_.edits.capacity() * sizeof(Edit);
}

void check_start(const Scene& scene, const VoxelModel& model, const Burr& burr, const Pose& start) {
  const Eigen::Vector3d middle = start.point(Eigen::Vector3d(0.0, 0.5 * burr.head_length_m, 0.0));
  const Eigen::Vector3d index = model.grid.index_from_world(middle);
  const Cell cell = (index.array() + 0.5).floor().cast<int>();
  if (!model.solid(cell)) return;
  std::ostringstream found;
  found << "a start with the burr's head inside the tooth, at ("
        << (middle / kMillimetre).transpose() << ") mm";
  throw InputError(scene.file, "[trajectory]", found.str(), "a start outside it");
}

}  // namespace sulcus
