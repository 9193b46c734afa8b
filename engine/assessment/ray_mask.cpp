#include "engine/assessment/ray_mask.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sulcus {

namespace {

constexpr double kFar = 1e18;

/// The lower envelope of parabolas of height `f` at whole places: the squared distances along a
/// line.
class Envelope {
 public:
  void run(const std::vector<double>& f, std::vector<double>& result) {
    const std::size_t n = f.size();
    at_.resize(n);
    from_.resize(n + 1);
    std::size_t last = 0;
    at_[0] = 0;
    from_[0] = -kFar;
    from_[1] = kFar;
    for (std::size_t q = 1; q < n; ++q) {
      double meets = meeting(f, q, at_[last]);
      while (last > 0 && meets <= from_[last]) meets = meeting(f, q, at_[--last]);
      if (meets <= from_[last]) {
        at_[last] = q;
      } else {
        at_[++last] = q;
        from_[last] = meets;
      }
      from_[last + 1] = kFar;
    }
    result.resize(n);
    for (std::size_t q = 0, k = 0; q < n; ++q) {
      while (from_[k + 1] < static_cast<double>(q)) ++k;
      const double d = static_cast<double>(q) - static_cast<double>(at_[k]);
      result[q] = d * d + f[at_[k]];
    }
  }

 private:
  static double meeting(const std::vector<double>& f, std::size_t q, std::size_t p) {
    const auto a = static_cast<double>(q), b = static_cast<double>(p);
    return ((f[q] + a * a) - (f[p] + b * b)) / (2.0 * (a - b));
  }
  std::vector<std::size_t> at_;
  std::vector<double> from_;
};

}  // namespace

std::vector<double> distances_to(const RayMask& set, const RayLattice& lattice) {
  std::vector<double> squared(lattice.size());
  for (std::size_t i = 0; i < squared.size(); ++i) squared[i] = set[i] ? 0.0 : kFar;
  Envelope envelope;
  std::vector<double> line, result;
  line.resize(static_cast<std::size_t>(lattice.nx));
  for (int y = 0; y < lattice.ny; ++y) {
    for (int x = 0; x < lattice.nx; ++x) {
      line[static_cast<std::size_t>(x)] = squared[lattice.place(x, y)];
    }
    envelope.run(line, result);
    for (int x = 0; x < lattice.nx; ++x) {
      squared[lattice.place(x, y)] = std::min(result[static_cast<std::size_t>(x)], kFar);
    }
  }
  line.resize(static_cast<std::size_t>(lattice.ny));
  for (int x = 0; x < lattice.nx; ++x) {
    for (int y = 0; y < lattice.ny; ++y) {
      line[static_cast<std::size_t>(y)] = squared[lattice.place(x, y)];
    }
    envelope.run(line, result);
    for (int y = 0; y < lattice.ny; ++y) {
      squared[lattice.place(x, y)] = result[static_cast<std::size_t>(y)];
    }
  }
  for (double& d : squared) {
    d = d >= 0.5 * kFar ? std::numeric_limits<double>::infinity() : lattice.pitch_mm * std::sqrt(d);
  }
  return squared;
}

RayMask opened(const RayMask& set, double radius_mm, const RayLattice& lattice) {
  RayMask outside(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) outside[i] = !set[i];
  const std::vector<double> inside_by = distances_to(outside, lattice);
  RayMask centres(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) centres[i] = set[i] && inside_by[i] > radius_mm;
  const std::vector<double> from_centre = distances_to(centres, lattice);
  RayMask result(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) result[i] = set[i] && from_centre[i] <= radius_mm;
  return result;
}

std::vector<RayComponent> components(const RayMask& set, std::size_t least,
                                     const RayLattice& lattice) {
  std::vector<RayComponent> found;
  RayMask left = set;
  for (std::size_t seed = 0; seed < set.size(); ++seed) {
    if (!left[seed]) continue;
    RayComponent component{seed};
    left[seed] = 0;
    for (std::size_t i = 0; i < component.size(); ++i) {
      const int x = lattice.x_of(component[i]), y = lattice.y_of(component[i]);
      for (const auto& [dx, dy] : kRaysBeside) {
        if (!lattice.holds(x + dx, y + dy)) continue;
        const std::size_t beside = lattice.place(x + dx, y + dy);
        if (!left[beside]) continue;
        left[beside] = 0;
        component.push_back(beside);
      }
    }
    if (component.size() >= least) found.push_back(std::move(component));
  }
  std::ranges::stable_sort(found, std::ranges::greater{}, &RayComponent::size);
  return found;
}

}  // namespace sulcus
