#include "engine/outcome/preparation_outcome.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/outcome/goal.hpp"
#include "engine/outcome/voxel_distance.hpp"

namespace sulcus {

namespace {

/// The voxel at a place in the order of squared_distances; `place` is less than their count.
Cell voxel_at(const VoxelSet& set, std::ptrdiff_t place) {
  for (const std::uint32_t leaf : set.leaves()) {
    const int here = count_voxels(set.voxels(leaf));
    if (place >= here) {
      place -= here;
      continue;
    }
    Cell found = set.grid().leaf_origin(leaf);
    for_each_voxel(set.voxels(leaf), [&](int at) {
      if (place-- == 0) found += cell_in_leaf(at);
    });
    return found;
  }
  return Cell::Zero();
}

/// `squared`: distances of the set's voxels, in voxels.
Reach reach_of(const VoxelSet& set, std::vector<std::uint32_t> squared) {
  if (squared.empty()) return {};
  const VoxelGrid& grid = set.grid();
  const auto metres = [&](std::uint32_t v) { return grid.voxel_m * std::sqrt(v); };
  const auto most = std::ranges::max_element(squared);
  Reach reach;
  reach.max_m = metres(*most);
  reach.furthest_m = grid.centre_world(voxel_at(set, most - squared.begin()));
  const auto last = static_cast<double>(squared.size() - 1);
  const auto p95 = squared.begin() + static_cast<std::ptrdiff_t>(std::ceil(0.95 * last));
  std::nth_element(squared.begin(), p95, squared.end());
  reach.p95_m = metres(*p95);
  return reach;
}

}  // namespace

PreparationOutcome::PreparationOutcome(const VoxelModel& start,
                                       std::span<const TissueSettings> tissues,
                                       std::optional<VoxelSet> target,
                                       std::optional<double> least_wall_m)
    : progress_(start, tissues, least_wall_m),
      removed_(start.grid),
      target_(std::move(target)),
      target_volume_(target_ ? filled_volume(*target_, start) : 0.0) {}

void PreparationOutcome::add(const Edit& edit) {
  if (edit.body != 0) return;
  progress_.add(edit);
  if (edit.is_gone()) removed_.insert(removed_.grid().cell_of_linear(edit.voxel));
}

std::optional<GoalFigures> PreparationOutcome::goal_figures(const VoxelModel& end) const {
  if (!target_) return {};
  const VoxelSet excess = without(removed_, *target_), missing = without(*target_, removed_);
  GoalFigures figures;
  figures.target_volume = target_volume_;
  figures.missing_volume = filled_volume(missing, end);
  const double both = target_volume_ - figures.missing_volume;
  figures.excess_volume = std::max(0.0, progress_.removed_volume() - both);  // sums are rounded
  const double sum = progress_.removed_volume() + target_volume_;
  figures.dice = sum > 0.0 ? 2.0 * both / sum : 1.0;
  figures.excess = reach_of(excess, squared_distances(excess, *target_));
  if (missing.count() == 0) {
    figures.missing = Reach{};
  } else if (const VoxelSet walls = outside_target(end, removed_, *target_); walls.count() > 0) {
    figures.missing = reach_of(missing, squared_distances(missing, walls));
  }
  return figures;
}

std::size_t PreparationOutcome::memory_bytes() const {
  return progress_.memory_bytes() + removed_.memory_bytes() +
         (target_ ? target_->memory_bytes() : 0);
}

}  // namespace sulcus
