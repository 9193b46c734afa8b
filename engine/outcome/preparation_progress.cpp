#include "engine/outcome/preparation_progress.hpp"

#include <algorithm>
#include <string_view>

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
                                         std::span<const TissueSettings> tissues)
    : grid_(start.grid),
      tissues_(start.tissues),
      caries_label_(label_of("caries", tissues)),
      pulp_label_(label_of("pulp", tissues)) {
  removed_.fill(std::vector<std::uint64_t>(tissues.size()));
  if (caries_label_) {
    caries_at_start_ = voxels_of_tissue(start, static_cast<std::uint8_t>(*caries_label_)).count();
  }
  if (pulp_label_) pulp_ = voxels_of_tissue(start, static_cast<std::uint8_t>(*pulp_label_));
}

void PreparationProgress::add(const Edit& edit) {
  if (edit.body != 0) return;
  const Cell c = grid_.cell_of_linear(edit.voxel);
  const std::uint8_t tissue = tissues_ ? tissues_->label(grid_.leaf_of(c), c) : std::uint8_t{0};
  ++removed_[edit.cause == EditCause::kCut ? 0 : 1][tissue];
  if (pulp_ && !pulp_exposed_tick_ && touches_pulp(c, tissue)) pulp_exposed_tick_ = edit.tick;
}

bool PreparationProgress::touches_pulp(const Cell& c, std::uint8_t tissue) const {
  if (tissue == *pulp_label_) return true;
  for (int axis = 0; axis < 3; ++axis) {
    // What is in the set still stands: had any of it gone, the pulp would have been exposed by it.
    if (pulp_->contains(c + Cell::Unit(axis)) || pulp_->contains(c - Cell::Unit(axis))) return true;
  }
  return false;
}

std::uint64_t PreparationProgress::removed_voxels(std::size_t tissue) const {
  return removed_voxels(EditCause::kCut, tissue) + removed_voxels(EditCause::kLoose, tissue);
}

std::optional<std::uint64_t> PreparationProgress::caries_left() const {
  if (!caries_label_) return {};
  return caries_at_start_ - removed_voxels(*caries_label_);
}

std::uint64_t PreparationProgress::pulp_removed() const {
  return pulp_label_ ? removed_voxels(*pulp_label_) : 0;
}

}  // namespace sulcus
