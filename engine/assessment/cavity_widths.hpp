#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/assessment/cut_walls.hpp"
#include "engine/assessment/ray_mask.hpp"

namespace sulcus {

/// A width of a cavity, and the ray where it is found.
struct CavityWidth {
  double mm = 0.0;
  std::size_t place = 0;
};

/// How wide a cavity is at one height, across the path of insertion.
class CavityWidths {
 public:
  /// `inside`: the rays that are in the cavity at `z_mm`. What is given outlives it.
  CavityWidths(const RayLattice& lattice, const RayMask& inside,
               const std::vector<WallPatch>& patches, double z_mm);

  /// The widest disc that fits; none where the cavity has no ray.
  std::optional<CavityWidth> widest() const;
  /// The widest that comes near to every part of it. It grows until it cannot be everywhere that it
  /// was: where its room falls apart, or where a part of the cavity is left beyond it. The same as
  /// the widest where neither is before that.
  std::optional<CavityWidth> isthmus() const;

 private:
  RayMask room_of(double radius_mm) const;
  RayMask far_from(const RayMask& room, double radius_mm) const;
  bool is_everywhere(double radius_mm) const;
  double between_walls(std::size_t place, double radius_mm) const;
  std::size_t narrowest(const RayMask& first, const RayMask& second, double radius_mm) const;
  RayMask mask_of(const RayComponent& part) const;

  const RayLattice& lattice_;
  const RayMask& inside_;
  const std::vector<WallPatch>& patches_;
  double z_mm_;
  std::vector<double> to_wall_;  // of each ray, mm
  std::size_t middle_;           // where it is greatest
};

}  // namespace sulcus
