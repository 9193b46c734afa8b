#include "engine/assessment/insertion_frame.hpp"

#include <algorithm>
#include <cmath>

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

double share_outside(const TriangleMesh& before, const TriangleMesh& after,
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
  return all > 0.0 ? outside / all : 1.0;
}

}  // namespace sulcus
