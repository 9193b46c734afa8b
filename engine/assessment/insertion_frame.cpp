#include "engine/assessment/insertion_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/core/units.hpp"

namespace sulcus {

Eigen::Affine3d insertion_frame_from_m(const Eigen::Vector3d& insertion) {
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(insertion, Eigen::Vector3d::UnitZ());
  return Eigen::Affine3d(Eigen::Scaling(1.0 / kMillimetre) * turn);
}

TriangleMesh moved(const TriangleMesh& mesh, const Eigen::Affine3d& to) {
  TriangleMesh result = mesh;
  transform(to, result);
  return result;
}

Eigen::AlignedBox2d box_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p.head<2>().cast<double>());
  return box;
}

RayLattice lattice_over(const Eigen::AlignedBox2d& box, double pitch_mm) {
  constexpr double kMostRays = 2e6;
  const Eigen::Vector2d size = box.sizes();
  const double pitch = std::max(pitch_mm, std::sqrt(size.x() * size.y() / kMostRays));
  // Between the places of whole tenths, where meshes made by hand have their edges.
  const Eigen::Vector2d first = box.min() - Eigen::Vector2d(1.93, 1.87) * pitch;
  const auto count = [&](double length) { return static_cast<int>(length / pitch) + 5; };
  return {first, pitch, count(size.x()), count(size.y())};
}

namespace {

RayMask removed_rays(const RayStack& before, const RayStack& after, const RayLattice& lattice) {
  RayMask removed(lattice.size());
  for (std::size_t place = 0; place < lattice.size(); ++place) {
    removed[place] = !without(before.spans(place), after.spans(place), kSame_mm).empty();
  }
  return removed;
}

/// Whether `test(place, z_mm)` holds round a point, by a little above and below beside it.
template <class Test>
bool all_round(const RayLattice& lattice, const Eigen::Vector3d& p_mm, const Test& test) {
  return std::ranges::all_of(kRaysBeside, [&](const std::array<int, 2>& side) {
    const Eigen::Vector2d at = p_mm.head<2>() + 1.2 * kSame_mm * Eigen::Vector2d(side[0], side[1]);
    const std::size_t place = lattice.nearest(at);
    return test(place, p_mm.z() - kSame_mm) && test(place, p_mm.z() + kSame_mm);
  });
}

}  // namespace

Eigen::AlignedBox2d box_of_removed(const TriangleMesh& before, const TriangleMesh& after) {
  const RayLattice rough = lattice_over(box_of(before).merged(box_of(after)), kCoarsePitch_mm);
  const RayMask removed = removed_rays(RayStack(before, rough), RayStack(after, rough), rough);
  Eigen::AlignedBox2d where;
  for (std::size_t place = 0; place < rough.size(); ++place) {
    if (removed[place]) where.extend(rough.at_mm(place));
  }
  return where;
}

Eigen::AlignedBox2d widened(const Eigen::AlignedBox2d& box, double by_mm) {
  const Eigen::Vector2d by = Eigen::Vector2d::Constant(by_mm);
  return {box.min() - by, box.max() + by};
}

bool is_deep_in(const RayStack& solid, const RayLattice& lattice, const Eigen::Vector3d& p_mm) {
  return all_round(lattice, p_mm,
                   [&](std::size_t place, double z_mm) { return solid.contains(place, z_mm); });
}

bool is_clear_of(const RayStack& solid, const RayLattice& lattice, const Eigen::Vector3d& p_mm) {
  return all_round(lattice, p_mm,
                   [&](std::size_t place, double z_mm) { return !solid.contains(place, z_mm); });
}

bool is_thick(const RayStack& before, const RayStack& after, const RayLattice& lattice,
              std::size_t place, const RayStack::Span& removed) {
  const Eigen::Vector2d at = lattice.at_mm(place);
  const Eigen::Vector3d middle(at.x(), at.y(), 0.5 * (removed.bottom_mm + removed.top_mm));
  return is_deep_in(before, lattice, middle) && is_clear_of(after, lattice, middle);
}

RayMask cut_rays(const RayStack& before, const RayStack& after, const RayLattice& lattice,
                 double reach_mm) {
  RayMask cut(lattice.size()), thick(lattice.size());
  for (std::size_t place = 0; place < lattice.size(); ++place) {
    for (const auto& gone : without(before.spans(place), after.spans(place), kSame_mm)) {
      cut[place] = 1;
      if (is_thick(before, after, lattice, place, gone)) thick[place] = 1;
    }
  }
  const std::vector<double> to_thick_mm = distances_to(thick, lattice);
  for (std::size_t place = 0; place < lattice.size(); ++place) {
    if (to_thick_mm[place] > reach_mm) cut[place] = 0;
  }
  return cut;
}

std::optional<double> share_outside(const TriangleMesh& before, const TriangleMesh& after,
                                    const Eigen::Vector3d& insertion) {
  const Eigen::Affine3d frame = insertion_frame_from_m(insertion);
  const TriangleMesh was = moved(before, frame), is = moved(after, frame);
  const RayLattice lattice = lattice_over(box_of(was).merged(box_of(is)), kCoarsePitch_mm);
  const RayStack was_solid(was, lattice), is_solid(is, lattice);
  double outside = 0.0, all = 0.0;
  for (std::size_t place = 0; place < lattice.size(); ++place) {
    for (const RayStack::Span& s : is_solid.spans(place)) all += s.top_mm - s.bottom_mm;
    for (const RayStack::Span& s : without(is_solid.spans(place), was_solid.spans(place), 0.0)) {
      outside += s.top_mm - s.bottom_mm;
    }
  }
  if (all == 0.0) return {};
  return outside / all;
}

}  // namespace sulcus
