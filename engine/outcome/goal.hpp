#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "engine/outcome/voxel_set.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"
#include "engine/volume/voxel_values.hpp"

namespace sulcus {

/// The box or cylinder that a scene's [goal] asks for, in world space, whatever tooth there is.
/// Immutable.
class Goal {
 public:
  explicit Goal(const GoalSettings& settings);

  bool contains(const Eigen::Vector3d& p_world) const;
  Eigen::AlignedBox3d bounds_world() const;

 private:
  GoalSettings settings_;
  Eigen::Affine3d world_from_goal_, goal_from_world_;
  double widening_;  // of the half widths, per metre of height
};

/// The target: the solid voxels whose centres lie in the goal.
VoxelSet target_voxels(const Goal& goal, const VoxelModel& start);

/// The tooth as it was at the start, without the target. `now`: the tooth after `removed` has gone.
VoxelSet outside_target(const VoxelModel& now, const VoxelSet& removed, const VoxelSet& target);

/// The target of a scene: what of the tooth lies in its goal; `from_file` is the goal's file on the
/// tooth's grid, where it names one. None without a goal. InputError of [goal] where it holds no
/// voxel of the tooth.
std::optional<VoxelSet> target_of_goal(const Scene& scene, const VoxelModel& start,
                                       const VoxelModel* from_file);

/// How far the surface lies from a goal's wall, m, at those of its voxels that the goal is about;
/// the others have none:
/// - below 0, still missing: of a voxel of the target, minus its distance to the nearest voxel of
///   the tooth outside the target, so that a layer of n voxels on the wall has -n voxels;
/// - above 0, cut beyond: of a voxel outside the target beside one that was removed, its distance
///   to the nearest voxel of the target, less one voxel: 0 where the cut ends at the wall.
/// Distances are from centre to centre, as in GoalFigures. `now`: the tooth after `removed` has
/// gone. Where the target is all of the tooth nothing is missing, as there is no wall. Runs on
/// oneTBB.
VoxelValues goal_distances(const VoxelModel& now, const VoxelSet& removed, const VoxelSet& target);

}  // namespace sulcus
