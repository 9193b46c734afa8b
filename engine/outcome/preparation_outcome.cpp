#include "engine/outcome/preparation_outcome.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/outcome/goal.hpp"
#include "engine/outcome/voxel_distance.hpp"

namespace sulcus {

namespace {

/// Of squared distances in voxels.
Reach reach_of(std::vector<std::uint32_t> squared, double voxel_m) {
  if (squared.empty()) return {};
  const auto metres = [voxel_m](std::uint32_t v) { return voxel_m * std::sqrt(v); };
  const auto last = static_cast<double>(squared.size() - 1);
  const auto p95 = squared.begin() + static_cast<std::ptrdiff_t>(std::ceil(0.95 * last));
  std::nth_element(squared.begin(), p95, squared.end());
  return {metres(*p95), metres(*std::max_element(p95, squared.end()))};
}

}  // namespace

PreparationOutcome::PreparationOutcome(const VoxelModel& start,
                                       std::span<const TissueSettings> tissues,
                                       std::optional<VoxelSet> target,
                                       std::optional<double> least_wall_m)
    : progress_(start, tissues, least_wall_m), removed_(start.grid), target_(std::move(target)) {}

void PreparationOutcome::add(const Edit& edit) {
  if (edit.body != 0) return;
  progress_.add(edit);
  if (edit.is_gone()) removed_.insert(removed_.grid().cell_of_linear(edit.voxel));
}

std::optional<GoalFigures> PreparationOutcome::goal_figures(const VoxelModel& end) const {
  if (!target_) return {};
  const double voxel_m = removed_.grid().voxel_m;
  const VoxelSet excess = without(removed_, *target_), missing = without(*target_, removed_);
  GoalFigures figures;
  figures.target_voxels = target_->count();
  figures.excess_voxels = excess.count();
  figures.missing_voxels = missing.count();
  const auto both = static_cast<double>(removed_.count() - excess.count());
  const auto sum = static_cast<double>(removed_.count() + target_->count());
  figures.dice = sum > 0.0 ? 2.0 * both / sum : 1.0;
  figures.excess = reach_of(squared_distances(excess, *target_), voxel_m);
  if (missing.count() == 0) {
    figures.missing = Reach{};
  } else if (const VoxelSet walls = outside_target(end, removed_, *target_); walls.count() > 0) {
    figures.missing = reach_of(squared_distances(missing, walls), voxel_m);
  }
  return figures;
}

std::size_t PreparationOutcome::memory_bytes() const {
  return progress_.memory_bytes() + removed_.memory_bytes() +
         (target_ ? target_->memory_bytes() : 0);
}

}  // namespace sulcus
