#include "haptics/start_place.hpp"

#include <iomanip>
#include <sstream>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "haptics/move_tool.hpp"
#include "haptics/way_through.hpp"

namespace sulcus {

namespace {

/// The height from which on there is nothing of a solid over a place, world.
double free_above(const VoxelModel& solid, const Pose& world_from_grid,
                  const Eigen::Vector3d& place) {
  const double voxel_m = solid.grid.voxel_m;
  const double across_m = solid.grid.cells.cast<double>().norm() * voxel_m;
  double free_m = place.z();
  for (Eigen::Vector3d above = place; above.z() < place.z() + across_m; above.z() += voxel_m) {
    if (is_inside(solid, world_from_grid, above)) free_m = above.z() + voxel_m;
  }
  return free_m;
}

}  // namespace

void check_start(const Scene& scene, const VoxelModel& model, std::span<const VoxelModel> bodies,
                 const Burr& burr, const Pose& start) {
  const Eigen::Vector3d middle = middle_of_head(burr, start);
  const auto check = [&](const VoxelModel& solid, const Pose& world_from_grid,
                         const std::string& name) {
    if (!is_inside(solid, world_from_grid, middle)) return;
    std::ostringstream found, expected;
    found << std::fixed << std::setprecision(3) << "a start with the burr's head inside " << name
          << ", at (" << middle.x() / kMillimetre << ", " << middle.y() / kMillimetre << ", "
          << middle.z() / kMillimetre << ") mm";
    expected << std::fixed << std::setprecision(3)
             << "a start outside it: there it is free from z = "
             << free_above(solid, world_from_grid, middle) / kMillimetre << " mm up";
    throw InputError(scene.file, "[trajectory]", found.str(), expected.str());
  };
  check(model, {}, "the tooth");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    check(bodies[i], scene.bodies[i].world_from_grid, "'" + scene.bodies[i].name + "'");
  }
}

}  // namespace sulcus
