#pragma once

#include <cstddef>
#include <cstdint>
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

/// What was removed, R, against the target T of a goal.
struct GoalFigures {
  std::uint64_t target_voxels = 0;
  std::uint64_t excess_voxels = 0;   // R without T
  std::uint64_t missing_voxels = 0;  // T without R
  double dice = 0.0;                 // 2 |R and T| / (|R| + |T|): 1 where they are the same
  /// How far the excess reaches beyond the target: of each of its voxels, from its centre to that
  /// of the nearest voxel of the target. A layer of n voxels reaches n voxels beyond.
  Reach excess;
  /// How thick what is missing stands on the target's walls: of each of its voxels to the nearest
  /// voxel of the tooth outside the target. None where the target is all of the tooth, which has no
  /// walls then.
  std::optional<Reach> missing;
};

/// `end`: the tooth after `removed` has gone. Runs on oneTBB.
GoalFigures goal_figures(const VoxelModel& end, const VoxelSet& removed, const VoxelSet& target);

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
  /// As sulcus::goal_figures, after all edits; none where the scene has no goal.
  std::optional<GoalFigures> goal_figures(const VoxelModel& end) const;

  std::size_t memory_bytes() const;

 private:
  PreparationProgress progress_;
  VoxelSet removed_;
  std::optional<VoxelSet> target_;
};

}  // namespace sulcus
