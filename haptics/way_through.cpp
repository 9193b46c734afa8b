#include "haptics/way_through.hpp"

#include <cmath>

namespace sulcus {

namespace {

/// A point that is further off than a grid may be is in none.
bool is_solid(const VoxelModel& body, const Eigen::Vector3d& index) noexcept {
  constexpr double kFarthest = 1e6;
  if (!(index.cwiseAbs().maxCoeff() < kFarthest)) return false;
  return body.solid((index.array() + 0.5).floor().cast<int>());
}

}  // namespace

bool is_inside(const VoxelModel& body, const Pose& world_from_grid,
               const Eigen::Vector3d& point_world) noexcept {
  return is_solid(body, body.grid.index_from_world(world_from_grid.inverse_point(point_world)));
}

bool goes_through(const VoxelModel& body, const Pose& world_from_grid,
                  const Eigen::Vector3d& from_world, const Eigen::Vector3d& to_world) noexcept {
  constexpr double kLook = 0.5;       // voxels
  constexpr double kMostLooks = 1e5;  // of a way that no tool goes
  const VoxelGrid& grid = body.grid;
  const Eigen::Vector3d from = grid.index_from_world(world_from_grid.inverse_point(from_world));
  const Eigen::Vector3d to = grid.index_from_world(world_from_grid.inverse_point(to_world));
  const double looks = std::ceil((to - from).norm() / kLook);
  if (!(looks > 1.0 && looks < kMostLooks) || is_solid(body, from)) return false;
  for (double look = 1.0; look <= looks; ++look) {
    if (is_solid(body, from + (look / looks) * (to - from))) return true;
  }
  return false;
}

}  // namespace sulcus
