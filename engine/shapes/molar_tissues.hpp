#pragma once

#include <array>

#include "engine/shapes/dual.hpp"
#include "engine/shapes/molar_surface.hpp"

// What the molar is made of, in millimetres and in the tooth's own space, as molar_surface.hpp.
// Enamel is what of the tooth lies outside `core`; pulp and lesion are cut out of the rest.

namespace sulcus::molar {

/// Height of the cementoenamel junction over (x, y): the neck, higher on the mesial and distal
/// sides.
template <class T>
T neck_height(const T& x, const T& y) {
  return T(0.55) + square(x) * T(0.045) - square(y) * T(0.008);
}

/// Dentine and pulp: negative inside. At the neck it meets the surface of the tooth, since the
/// layer of enamel there has no thickness; below, the layer is negative and all of the tooth is
/// core.
template <class T>
T core(const Point<T>& p, const T& tooth_value) {
  using std::sqrt;
  const T above_neck = p.z - neck_height(p.x, p.y);
  const T layer = above_neck * T(0.95) / sqrt(square(above_neck) + T(4.0));

  T horns = cusp_height(kCusps[0], p.x, p.y);
  for (std::size_t n = 1; n < kCusps.size(); ++n) {
    horns = smooth_max(horns, cusp_height(kCusps[n], p.x, p.y), 1.9);
  }
  const T roof = (p.z - (horns - T(2.05))) * T(0.62);
  return smooth_max(T(tooth_value + layer), roof, 0.5);
}

/// Distance to a straight rod with round ends from `a` to `b`.
template <class T>
T rod(const Point<T>& p, const std::array<double, 3>& a, const std::array<double, 3>& b,
      double radius) {
  using std::sqrt;
  const std::array<double, 3> axis{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double length2 = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
  const T dx = p.x - T(a[0]), dy = p.y - T(a[1]), dz = p.z - T(a[2]);
  T t = (dx * T(axis[0]) + dy * T(axis[1]) + dz * T(axis[2])) * T(1.0 / length2);
  if (plain(t) < 0.0) t = T(0.0);
  if (plain(t) > 1.0) t = T(1.0);
  return sqrt(square(T(dx - t * T(axis[0]))) + square(T(dy - t * T(axis[1]))) +
              square(T(dz - t * T(axis[2]))) + T(1e-12)) -
         T(radius);
}

// clang-format off
//                           z: -13    -12    -11    -10     -9     -8     -7     -6     -5     -4     -3     -2     -1      0      1      2      3      4      5      6      7      8      9     10
inline constexpr Curve kCanalRadius  {-1.20, -0.60, -0.10,  0.14,  0.18,  0.21,  0.24,  0.28,  0.32,  0.37,  0.43,  0.50,  0.55,  0.50,  0.20, -0.40, -1.00, -1.60, -2.20, -2.80, -3.40, -4.00, -4.60, -5.20};
// clang-format on

/// Chamber, a horn under each cusp, two canals in the mesial root and a flat one in the distal.
template <class T>
T pulp(const Point<T>& p) {
  using std::sqrt;
  const T x2 = square(T(p.x * T(1.0 / 2.5))), y2 = square(T(p.y * T(1.0 / 1.7))),
          z2 = square(T((p.z - T(0.5)) * T(1.0 / 1.3)));
  const T quartic = square(x2) + square(y2) + square(z2) + (x2 * y2 + (x2 + y2) * z2) * T(0.9);
  T result = (sqrt(sqrt(quartic + T(1e-4))) - T(1.0)) * T(1.3);
  for (const Cusp& cusp : kCusps) {
    const double top = cusp.y > 0.0 ? 4.5 : 4.0;
    result = smooth_min(
        result,
        rod(p, {0.70 * cusp.x, 0.40 * cusp.y, 1.2}, {0.90 * cusp.x, 0.78 * cusp.y, top}, 0.2), 1.0);
  }
  const Knots<T> at(p.z);
  const T size = at(kCanalRadius);
  const T mesial_x = p.x - at(kMesialRootX), apart = at(kMesialRootB) * T(0.38);
  for (const double side : {-1.0, 1.0}) {
    const T canal = sqrt(square(mesial_x) + square(T(p.y - apart * T(side))) + T(1e-4)) - size;
    result = smooth_min(result, T(canal * T(0.85)), 0.5);
  }
  const T distal_x = p.x - at(kDistalRootX);
  const T canal = sqrt(square(distal_x) + square(T(p.y * T(0.45))) + T(1e-4)) - size;
  return smooth_min(result, T(canal * T(0.85)), 0.5);
}

/// The bottom of the central pit, in (x, y).
inline constexpr double kPitX = 0.46, kPitY = -0.12;
/// Depth of the enamel below it.
inline constexpr double kPitEnamel = 1.5;

/// A lesion of the given radius: it came in through a narrow path at the central pit, whose bottom
/// is at `pit_z`, and has spread under the enamel into the dentine.
template <class T>
T lesion(const Point<T>& p, double radius, double pit_z) {
  using std::sqrt;
  const double junction = pit_z - kPitEnamel, flatness = 1.3;
  const double centre = junction - 0.55 * radius / flatness;
  const T body = (sqrt(square(T(p.x - T(kPitX))) + square(T(p.y - T(kPitY))) +
                       square(T((p.z - T(centre)) * T(flatness))) + T(1e-12)) -
                  T(radius)) *
                 T(1.0 / flatness);
  const T path = rod(p, {kPitX, kPitY, pit_z + 0.3}, {kPitX, kPitY, centre}, 0.25 * radius);
  return smooth_min(body, path, 0.3 * radius);
}

}  // namespace sulcus::molar
