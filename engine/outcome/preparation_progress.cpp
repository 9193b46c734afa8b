#include "engine/outcome/preparation_progress.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace sulcus {

namespace {

std::optional<std::size_t> label_of(std::string_view name,
                                    std::span<const TissueSettings> tissues) {
  const auto found = std::ranges::find(tissues, name, &TissueSettings::name);
  if (found == tissues.end()) return {};
  return static_cast<std::size_t>(found - tissues.begin());
}

}  // namespace

PreparationProgress::PreparationProgress(const VoxelModel& start,
                                         std::span<const TissueSettings> tissues,
                                         std::optional<double> least_wall_m)
    : grid_(start.grid),
      tissues_(start.tissues),
      levels_(start),
      caries_label_(label_of("caries", tissues)),
      pulp_label_(label_of("pulp", tissues)),
      least_wall_m_(least_wall_m) {
  removed_.fill(std::vector<std::uint64_t>(tissues.size()));
  removed_levels_ = removed_;
  if (caries_label_) {
    const VoxelSet caries = voxels_of_tissue(start, static_cast<std::uint8_t>(*caries_label_));
    caries_at_start_ = filled_volume(caries, start);
  }
  if (pulp_label_) {
    VoxelSet pulp = voxels_of_tissue(start, static_cast<std::uint8_t>(*pulp_label_));
    if (pulp.count() > 0) pulp_distance_.emplace(std::move(pulp));
  }
}

void PreparationProgress::add(const Edit& edit) {
  if (edit.body != 0) return;
  const Cell c = grid_.cell_of_linear(edit.voxel);
  const std::uint8_t tissue = tissues_ ? tissues_->label(grid_.leaf_of(c), c) : std::uint8_t{0};
  const std::size_t cause = edit.cause == EditCause::kCut ? 0 : 1;
  removed_levels_[cause][tissue] += std::uint64_t{levels_.before(edit)} - edit.level;
  if (!edit.is_gone()) return;
  ++removed_[cause][tissue];
  if (pulp_distance_ && !pulp_exposed_tick_ && touches_pulp(c, tissue)) {
    pulp_exposed_tick_ = edit.tick;
  }
  if (pulp_distance_ && !pulp_exposed_tick_) pulp_distance_->remove(c);
  if (least_wall_m_ && !pulp_near_tick_ && wall_over_pulp_m().value_or(HUGE_VAL) < *least_wall_m_) {
    pulp_near_tick_ = edit.tick;
  }
}

bool PreparationProgress::touches_pulp(const Cell& c, std::uint8_t tissue) const {
  if (tissue == *pulp_label_) return true;
  const VoxelSet& pulp = pulp_distance_->pulp();
  for (int axis = 0; axis < 3; ++axis) {
    // What is in the set still stands: had any of it gone, the pulp would have been exposed by it.
    if (pulp.contains(c + Cell::Unit(axis)) || pulp.contains(c - Cell::Unit(axis))) return true;
  }
  return false;
}

std::optional<double> PreparationProgress::wall_over_pulp_m() const {
  if (pulp_exposed_tick_) return 0.0;
  if (!pulp_distance_ || !pulp_distance_->least_squared()) return {};
  return grid_.voxel_m * (std::sqrt(*pulp_distance_->least_squared()) - 1.0);
}

double PreparationProgress::removed_volume() const {
  double volume = 0.0;
  for (std::size_t tissue = 0; tissue < removed_[0].size(); ++tissue) {
    volume += removed_volume(tissue);
  }
  return volume;
}

double PreparationProgress::removed_volume(std::size_t tissue) const {
  return removed_volume(EditCause::kCut, tissue) + removed_volume(EditCause::kLoose, tissue);
}

std::optional<double> PreparationProgress::caries_left() const {
  if (!caries_label_) return {};
  return caries_at_start_ - removed_volume(*caries_label_);
}

double PreparationProgress::pulp_removed() const {
  return pulp_label_ ? removed_volume(*pulp_label_) : 0.0;
}

}  // namespace sulcus
