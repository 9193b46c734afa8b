#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/outcome/pulp_distance.hpp"
#include "engine/outcome/voxel_set.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/level_changes.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What can be told of a preparation edit by edit: volumes removed, caries left, and when the pulp
/// was exposed. Tissues are known by their names, "caries" and "pulp"; nothing is kept or asked of
/// one that the scene does not name. Used by one thread.
class PreparationProgress {
 public:
  /// Walks the volume once where the scene names caries or pulp. Of fractions it keeps a copy.
  /// `least_wall_m`: what the scene wants to stay over the pulp.
  PreparationProgress(const VoxelModel& start, std::span<const TissueSettings> tissues,
                      std::optional<double> least_wall_m = {});

  /// The edits of a run in its order, each of a voxel that was solid. Those of other bodies than
  /// the workpiece are left out.
  void add(const Edit& edit);

  /// Voxels of a tissue that are gone, by an index into the scene's tissues. `cause`: kCut or
  /// kLoose.
  std::uint64_t removed_voxels(EditCause cause, std::size_t tissue) const {
    return removed_[static_cast<std::size_t>(cause)][tissue];
  }
  /// What they took up, in voxels: with fractions by what of each was filled, and what was cut of
  /// those that still stand as well.
  double removed_volume(EditCause cause, std::size_t tissue) const {
    return static_cast<double>(removed_levels_[static_cast<std::size_t>(cause)][tissue]) /
           kFullLevel;
  }
  /// Of all tissues, cut and come loose.
  double removed_volume() const;
  /// In voxels, as above. None where the scene names no caries.
  std::optional<double> caries_left() const;

  /// Whether the scene names a pulp.
  bool has_pulp() const { return pulp_label_.has_value(); }
  /// The tick of the first edit that removed a voxel of the pulp or one with a face on it.
  std::optional<std::uint64_t> pulp_exposed_tick() const { return pulp_exposed_tick_; }
  /// Thickness of the thinnest wall between what was removed and the pulp, m: the least distance of
  /// their voxels' centres less one voxel, 0 once the pulp is exposed. (The nearest removed voxel
  /// always is one of the cut surface.) None where the scene names no pulp, the tooth has none or
  /// nothing was removed.
  std::optional<double> wall_over_pulp_m() const;
  /// The tick of the first edit that left less than the scene wants over the pulp; none where it
  /// wants nothing.
  std::optional<std::uint64_t> pulp_near_tick() const { return pulp_near_tick_; }
  /// In voxels, as above; 0 where the scene names none.
  double pulp_removed() const;

  std::size_t memory_bytes() const {
    return levels_.memory_bytes() + (pulp_distance_ ? pulp_distance_->memory_bytes() : 0);
  }

 private:
  bool touches_pulp(const Cell& c, std::uint8_t tissue) const;
  double removed_volume(std::size_t tissue) const;

  VoxelGrid grid_;
  std::shared_ptr<const TissueMap> tissues_;
  LevelChanges levels_;
  std::array<std::vector<std::uint64_t>, 2> removed_, removed_levels_;  // by cause, then tissue
  std::optional<std::size_t> caries_label_, pulp_label_;
  double caries_at_start_ = 0.0;
  std::optional<PulpDistance> pulp_distance_;  // where the tooth has any pulp
  std::optional<std::uint64_t> pulp_exposed_tick_, pulp_near_tick_;
  std::optional<double> least_wall_m_;
};

}  // namespace sulcus
