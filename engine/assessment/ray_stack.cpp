#include "engine/assessment/ray_stack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace sulcus {

namespace {

struct Crossing {
  std::size_t place;
  double z_mm;
  int step;  // of how many solids one is in: 1 on entering, -1 on leaving
};

bool before(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
}

/// On which side of the line from a to b a point lies. The two triangles at an edge ask in opposite
/// directions and hear opposite answers, also on the line itself.
bool is_left(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  const bool swapped = before(b, a);
  const Eigen::Vector2d &from = swapped ? b : a, &to = swapped ? a : b;
  const Eigen::Vector2d along = to - from, at = p - from;
  return (along.x() * at.y() - along.y() * at.x() >= 0.0) != swapped;
}

void add_crossings(const std::array<Eigen::Vector3d, 3>& corner, const RayLattice& lattice,
                   std::vector<Crossing>& crossings) {
  const Eigen::Vector2d a = corner[0].head<2>(), b = corner[1].head<2>(), c = corner[2].head<2>();
  const Eigen::Vector2d ab = b - a, ac = c - a;
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  if (area == 0.0) return;
  const Eigen::Array2d low = (a.cwiseMin(b).cwiseMin(c) - lattice.first_mm) / lattice.pitch_mm;
  const Eigen::Array2d high = (a.cwiseMax(b).cwiseMax(c) - lattice.first_mm) / lattice.pitch_mm;
  const auto at_least = [](double v) { return static_cast<int>(std::floor(std::max(v, 0.0))); };
  const auto at_most = [](double v, int n) {
    return static_cast<int>(std::ceil(std::min(v, static_cast<double>(n - 1))));
  };
  const bool up = area > 0.0;
  for (int y = at_least(low.y()); y <= at_most(high.y(), lattice.ny); ++y) {
    for (int x = at_least(low.x()); x <= at_most(high.x(), lattice.nx); ++x) {
      const std::size_t place = lattice.place(x, y);
      const Eigen::Vector2d p = lattice.at_mm(place);
      if (is_left(a, b, p) != up || is_left(b, c, p) != up || is_left(c, a, p) != up) continue;
      const Eigen::Vector2d ap = p - a;
      const double u = (ap.x() * ac.y() - ap.y() * ac.x()) / area;
      const double v = (ab.x() * ap.y() - ab.y() * ap.x()) / area;
      const double z =
          corner[0].z() + u * (corner[1].z() - corner[0].z()) + v * (corner[2].z() - corner[0].z());
      crossings.push_back({place, z, up ? -1 : 1});
    }
  }
}

}  // namespace

std::size_t RayLattice::nearest(const Eigen::Vector2d& p_mm) const {
  const Eigen::Array2d at = (p_mm - first_mm) / pitch_mm;
  const auto clamped = [](double v, int n) {
    return static_cast<int>(std::lround(std::clamp(v, 0.0, static_cast<double>(n - 1))));
  };
  return place(clamped(at.x(), nx), clamped(at.y(), ny));
}

RayStack::RayStack(const TriangleMesh& mesh, const RayLattice& lattice) {
  std::vector<Crossing> crossings;
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) corner[i] = mesh.positions[triangle[i]].cast<double>();
    add_crossings(corner, lattice, crossings);
  }
  std::ranges::sort(crossings, [](const Crossing& a, const Crossing& b) {
    if (a.place != b.place) return a.place < b.place;
    return a.z_mm != b.z_mm ? a.z_mm < b.z_mm : a.step > b.step;
  });
  begin_.assign(lattice.size() + 1, 0);
  std::size_t next = 0;
  for (std::size_t place = 0; place < lattice.size(); ++place) {
    begin_[place] = spans_.size();
    int depth = 0;
    double bottom = 0.0;
    for (; next < crossings.size() && crossings[next].place == place; ++next) {
      const int was = std::exchange(depth, depth + crossings[next].step);
      if (was <= 0 && depth > 0) bottom = crossings[next].z_mm;
      if (was > 0 && depth <= 0) spans_.push_back({bottom, crossings[next].z_mm});
    }
  }
  begin_[lattice.size()] = spans_.size();
}

bool RayStack::contains(std::size_t place, double z_mm) const {
  return std::ranges::any_of(
      spans(place), [&](const Span& s) { return s.bottom_mm <= z_mm && z_mm <= s.top_mm; });
}

std::vector<RayStack::Span> without(std::span<const RayStack::Span> a,
                                    std::span<const RayStack::Span> b, double least_mm) {
  std::vector<RayStack::Span> left;
  const auto add = [&](double bottom, double top) {
    if (top - bottom >= least_mm) left.push_back({bottom, top});
  };
  for (const RayStack::Span& whole : a) {
    double from = whole.bottom_mm;
    for (const RayStack::Span& taken : b) {
      if (taken.top_mm <= from || taken.bottom_mm >= whole.top_mm) continue;
      add(from, taken.bottom_mm);
      from = std::max(from, taken.top_mm);
    }
    add(from, whole.top_mm);
  }
  return left;
}

}  // namespace sulcus
