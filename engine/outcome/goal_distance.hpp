#pragma once

#include "engine/outcome/voxel_set.hpp"
#include "engine/volume/voxel_model.hpp"
#include "engine/volume/voxel_values.hpp"

namespace sulcus {

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
