#include "engine/assessment/cavity_widths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/units.hpp"

namespace sulcus {

CavityWidths::CavityWidths(const RayLattice& lattice, const RayMask& inside,
                           const std::vector<WallPatch>& patches, double z_mm)
    : lattice_(lattice), inside_(inside), patches_(patches), z_mm_(z_mm) {
  RayMask outside(inside.size());
  for (std::size_t i = 0; i < inside.size(); ++i) outside[i] = !inside[i];
  to_wall_ = distances_to(outside, lattice);
  middle_ = static_cast<std::size_t>(std::ranges::max_element(to_wall_) - to_wall_.begin());
}

std::optional<CavityWidth> CavityWidths::widest() const {
  if (!(to_wall_[middle_] > 0.0)) return {};
  const double half = 0.5 * lattice_.pitch_mm;
  return CavityWidth{between_walls(middle_, to_wall_[middle_] - half), middle_};
}

std::optional<CavityWidth> CavityWidths::isthmus() const {
  const double half = 0.5 * lattice_.pitch_mm, most = to_wall_[middle_];
  double reaches = 0.1, too_wide = most;  // by halving: distances to all take a while
  while (too_wide - reaches > half) {
    const double radius = 0.5 * (reaches + too_wide);
    (is_everywhere(radius) ? reaches : too_wide) = radius;
  }
  for (double radius = 0.1; radius < too_wide; radius += half) {
    const std::vector<RayComponent> parts = components(room_of(radius), 1, lattice_);
    // A part into which a clearly larger disc would fit is more than a bulge of the wall.
    const auto counts = [&](const RayComponent& part) {
      return std::ranges::any_of(part,
                                 [&](std::size_t i) { return to_wall_[i] > 1.15 * radius + half; });
    };
    if (std::ranges::count_if(parts, counts) < 2) continue;
    const std::size_t at = narrowest(mask_of(parts[0]), mask_of(parts[1]), radius);
    return CavityWidth{between_walls(at, radius - half), at};
  }
  if (too_wide >= most) return widest();
  const RayMask room = room_of(too_wide);
  const std::size_t at = narrowest(room, far_from(room, too_wide), reaches);
  return CavityWidth{between_walls(at, reaches), at};
}

/// Where the middle of a disc can be.
RayMask CavityWidths::room_of(double radius_mm) const {
  RayMask room(to_wall_.size());
  for (std::size_t i = 0; i < room.size(); ++i) room[i] = to_wall_[i] > radius_mm;
  return room;
}

/// What of the cavity lies further than a disc is wide from where its middle can be.
RayMask CavityWidths::far_from(const RayMask& room, double radius_mm) const {
  RayMask far(room.size());
  const std::vector<double> to_room = distances_to(room, lattice_);
  for (std::size_t i = 0; i < far.size(); ++i) far[i] = inside_[i] && to_room[i] > 2.0 * radius_mm;
  return far;
}

bool CavityWidths::is_everywhere(double radius_mm) const {
  const RayMask far = far_from(room_of(radius_mm), radius_mm);
  return std::ranges::find(far, char{1}) == far.end();
}

/// How far apart the walls stand that a disc of this radius touches: by the fits to them where
/// there are some, since the disc touches what stands out of the walls.
double CavityWidths::between_walls(std::size_t place, double radius_mm) const {
  constexpr double kReach_mm = 0.06;
  const Eigen::Vector2d middle = lattice_.at_mm(place);
  double sum = 0.0, area = 0.0;
  for (const WallPatch& patch : patches_) {
    const Eigen::Vector2d from = patch.at_mm.head<2>() - middle;
    if (from.norm() > 1.5 * radius_mm + kReach_mm) continue;
    const double wider = (z_mm_ - patch.at_mm.z()) * std::tan(patch.taper_deg * kDegree);
    const double away = -patch.facing.dot(from) + wider;
    if (std::abs(away - radius_mm) > kReach_mm) continue;
    sum += patch.area_mm2 * away;
    area += patch.area_mm2;
  }
  return 2.0 * (area > 0.0 ? sum / area : radius_mm);
}

/// Between two parts: where the way from one to the other is the shortest, of the places where a
/// disc of the radius fits.
std::size_t CavityWidths::narrowest(const RayMask& first, const RayMask& second,
                                    double radius_mm) const {
  const std::vector<double> a = distances_to(first, lattice_), b = distances_to(second, lattice_);
  std::size_t best = middle_;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < to_wall_.size(); ++i) {
    const double sum = a[i] + b[i];
    if (to_wall_[i] > radius_mm - lattice_.pitch_mm && sum < least) least = sum, best = i;
  }
  return best;
}

RayMask CavityWidths::mask_of(const RayComponent& part) const {
  RayMask mask(to_wall_.size());
  for (const std::size_t place : part) mask[place] = 1;
  return mask;
}

}  // namespace sulcus
