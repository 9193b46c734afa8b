#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

#include "engine/shapes/implicit_shape.hpp"

namespace sulcus {

/// Share of a unit cube about the origin in which n'x <= -distance, n unit: closed form, by
/// inclusion and exclusion of the corners that lie behind the plane.
inline double share_behind_plane(const Eigen::Vector3d& n, double distance) {
  constexpr double kAlongAxis = 1e-5;  // a component below it counts as none
  std::array<double, 3> a{std::abs(n.x()), std::abs(n.y()), std::abs(n.z())};
  std::ranges::sort(a);
  const double all = a[0] + a[1] + a[2], t = 0.5 * all - distance;
  if (t <= 0.0) return 0.0;
  if (t >= all) return 1.0;
  if (a[1] < kAlongAxis) return std::clamp(0.5 - distance / a[2], 0.0, 1.0);
  const auto power = [](double v, int p) { return v > 0.0 ? std::pow(v, p) : 0.0; };
  if (a[0] < kAlongAxis) {
    return (power(t, 2) - power(t - a[1], 2) - power(t - a[2], 2) + power(t - a[1] - a[2], 2)) /
           (2.0 * a[1] * a[2]);
  }
  double sum = power(t, 3);
  for (int i = 0; i < 3; ++i) sum += power(t - (all - a[i]), 3) - power(t - a[i], 3);
  return (sum - power(t - all, 3)) / (6.0 * a[0] * a[1] * a[2]);
}

/// Share of a cube of edge `size_m` about `centre`, both in the shape's space, that is solid; its
/// edges are along the columns of `axes`. Where the shape is a plane over the cube to within
/// `kBent` of its size, by the plane's closed form at the cube's mean value; else by the sum of
/// 4 x 4 x 4 such parts, each by its own plane. On a surface of curvature k the first errs by less
/// than 0.01 k size, and edges and corners are as exact as the parts are small.
template <ImplicitShape S>
double solid_share(const S& shape, const Eigen::Vector3d& centre, const Eigen::Matrix3d& axes,
                   double size_m) {
  constexpr double kBent = 0.03;
  constexpr int kParts = 4;
  const auto by_plane = [&](const Eigen::Vector3d& at, double size, double value_m) {
    const Eigen::Vector3d g = axes.transpose() * shape.gradient(at);
    const double slope = g.norm();
    if (!(slope > 0.0)) return value_m <= 0.0 ? 1.0 : 0.0;
    return share_behind_plane(g / slope, value_m / (slope * size));
  };
  const double value = shape.value(centre);
  const Eigen::Vector3d g = axes.transpose() * shape.gradient(centre);
  double bent = 0.0, mean = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d to(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5,
                             corner & 4 ? 0.5 : -0.5);
    const double more = shape.value(centre + axes * to * size_m) - value - g.dot(to) * size_m;
    bent = std::max(bent, std::abs(more));
    mean += more / 8.0;
  }
  // Squared distances from the centre are 3/4 at the corners and 1/4 in the mean.
  if (bent <= kBent * g.norm() * size_m) return by_plane(centre, size_m, value + mean / 3.0);
  const double part = size_m / kParts;
  double share = 0.0;
  for (int n = 0; n < kParts * kParts * kParts; ++n) {
    const Eigen::Vector3i place(n % kParts, n / kParts % kParts, n / (kParts * kParts));
    const Eigen::Vector3d to = place.cast<double>().array() - 0.5 * (kParts - 1);
    const Eigen::Vector3d at = centre + axes * to * part;
    share += by_plane(at, part, shape.value(at));
  }
  return share / (kParts * kParts * kParts);
}

}  // namespace sulcus
