#include "haptics/start_place.hpp"

#include <sstream>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "haptics/move_tool.hpp"
#include "haptics/way_through.hpp"

namespace sulcus {

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
