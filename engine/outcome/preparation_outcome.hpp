#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "engine/outcome/preparation_progress.hpp"
#include "engine/outcome/voxel_set.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Distances over some voxels, m; 0 where there are none of them.
struct Reach {
  double p95_m = 0.0;  // what 95 % of the voxels do not exceed
  double max_m = 0.0;
  std::optional<Eigen::Vector3d> furthest_m;  // where the greatest is, the grid's world space
};

/// What was removed, R, against the target T of a goal. Volumes are in voxels, with fractions by
/// what of each was filled (as PreparationProgress::removed_volume); distances are of whole voxels.
struct GoalFigures {
  double target_volume = 0.0;
  double excess_volume = 0.0;   // R without T
  double missing_volume = 0.0;  // T without R
  double dice = 0.0;            // 2 |R and T| / (|R| + |T|): 1 where they are the same
  /// How far the excess reaches beyond the target: of each of its voxels, from its centre to that
  /// of the nearest voxel of the target. A layer of n voxels reaches n voxels beyond.
  Reach excess;
  /// How thick what is missing stands on the target's walls: of each of its voxels to the nearest
  /// voxel of the tooth outside the target. None where the target is all of the tooth, which has no
  /// walls then.
  std::optional<Reach> missing;
};

/// What a preparation did to the tooth, from the tooth at the start and the edits of a run. It
/// keeps the voxels that went, by leaf. Used by one thread.
class PreparationOutcome {
 public:
  /// `start` is not kept. `target`: as target_of_goal gives it; `least_wall_m`: as
  /// PreparationProgress takes it.
  PreparationOutcome(const VoxelModel& start, std::span<const TissueSettings> tissues,
                     std::optional<VoxelSet> target, std::optional<double> least_wall_m = {});

  /// As PreparationProgress::add.
  void add(const Edit& edit);

  const PreparationProgress& progress() const { return progress_; }
  /// The voxels that are gone.
  const VoxelSet& removed() const { return removed_; }
  /// After all edits, which left `end`; none where the scene has no goal. Runs on oneTBB.
  std::optional<GoalFigures> goal_figures(const VoxelModel& end) const;

  std::size_t memory_bytes() const;

 private:
  PreparationProgress progress_;
  VoxelSet removed_;
  std::optional<VoxelSet> target_;
  double target_volume_ = 0.0;  // at the start
};

}  // namespace sulcus
