#include "engine/outcome/goal.hpp"

#include <cmath>
#include <sstream>

#include "engine/core/error.hpp"
#include "engine/core/pose.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

/// Half of what the goal measures at the height of its centre, in its own space.
Eigen::Vector3d half_size_m(const GoalSettings& goal) {
  if (goal.shape == GoalShape::kBox) return 0.5 * goal.size_m;
  return 0.5 * Eigen::Vector3d(goal.diameter_m, goal.diameter_m, goal.depth_m);
}

Eigen::Affine3d world_from_goal(const GoalSettings& goal) {
  return Eigen::Translation3d(goal.position_m) * rotation_xyz(goal.rotation);
}

}  // namespace

Goal::Goal(const GoalSettings& settings)
    : settings_(settings),
      world_from_goal_(world_from_goal(settings)),
      goal_from_world_(world_from_goal_.inverse(Eigen::Isometry)),
      widening_(std::tan(settings.taper)) {}

bool Goal::contains(const Eigen::Vector3d& p_world) const {
  const Eigen::Vector3d p = goal_from_world_ * p_world;
  const Eigen::Vector3d half = half_size_m(settings_);
  if (std::abs(p.z()) > half.z()) return false;
  const double wider = widening_ * p.z();
  if (settings_.shape == GoalShape::kCylinder) {
    return p.head<2>().squaredNorm() <= (half.x() + wider) * (half.x() + wider);
  }
  return std::abs(p.x()) <= half.x() + wider && std::abs(p.y()) <= half.y() + wider;
}

Eigen::AlignedBox3d Goal::bounds_world() const {
  Eigen::Vector3d half = half_size_m(settings_);
  half.head<2>().array() += std::abs(widening_) * half.z();
  Eigen::AlignedBox3d bounds;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    bounds.extend(world_from_goal_ * half.cwiseProduct(sign));
  }
  return bounds;
}

VoxelSet target_voxels(const Goal& goal, const VoxelModel& start) {
  const VoxelGrid& grid = start.grid;
  const Eigen::AlignedBox3d bounds = goal.bounds_world();
  VoxelSet target(grid);
  for (std::uint32_t leaf = 0; leaf < start.leaves.size(); ++leaf) {
    if (!any(start.leaves[leaf])) continue;
    const Cell first = grid.leaf_origin(leaf), last = first + Cell::Constant(kLeafEdge - 1);
    if (!bounds.intersects({grid.centre_world(first), grid.centre_world(last)})) continue;
    LeafBits inside;
    for_each_voxel(start.leaves[leaf], [&](int place) {
      if (goal.contains(grid.centre_world(first + cell_in_leaf(place)))) inside.set(place);
    });
    target.insert(leaf, inside);
  }
  return target;
}

VoxelSet outside_target(const VoxelModel& now, const VoxelSet& removed, const VoxelSet& target) {
  VoxelSet outside = without(removed, target);
  for (std::uint32_t leaf = 0; leaf < now.leaves.size(); ++leaf) {
    outside.insert(leaf, without(now.leaves[leaf], target.voxels(leaf)));
  }
  return outside;
}

std::optional<VoxelSet> target_of_goal(const Scene& scene, const VoxelModel& start,
                                       const VoxelModel* from_file) {
  if (!scene.goal) return {};
  VoxelSet target(start.grid);
  if (from_file) {
    for (std::uint32_t leaf = 0; leaf < start.leaves.size(); ++leaf) {
      target.insert(leaf, start.leaves[leaf] & from_file->leaves[leaf]);
    }
  } else {
    target = target_voxels(Goal(*scene.goal), start);
  }
  if (target.count() > 0) return target;
  std::ostringstream found;
  found << "a goal without a voxel of the tooth, around ("
        << (scene.goal->position_m / kMillimetre).transpose() << ") mm";
  throw InputError(scene.file, "[goal]", found.str(), "a target that the tooth reaches into");
}

}  // namespace sulcus
