#pragma once

#include <array>
#include <cstddef>

#include "engine/shapes/dual.hpp"

namespace sulcus::molar {

// Curves along the tooth's height: uniform cubic B-splines (twice differentiable) over the same
// knots, one control value each millimetre, so that their weights are computed once a point.

inline constexpr double kFirstKnot = -13.0;  // mm, height of the first control value
inline constexpr std::size_t kKnots = 24;    // up to z = +10 mm
using Curve = std::array<double, kKnots>;

/// The weights of the four control values that reach a height.
template <class T>
struct Knots {
  std::size_t first = 0;
  std::array<T, 4> weight;

  /// At height z, mm; constant beyond the ends.
  explicit Knots(const T& z) {
    const T at = z - T(kFirstKnot + 1.0);  // a segment begins at its second control value
    constexpr double kLast = static_cast<double>(kKnots - 3);
    T t = at;
    if (plain(at) <= 0.0) {
      t = T(0.0);
    } else if (plain(at) >= kLast) {
      first = kKnots - 4;
      t = T(1.0);
    } else {
      first = static_cast<std::size_t>(plain(at));
      t = at - T(static_cast<double>(first));
    }
    const T s = T(1.0) - t, t2 = t * t, s2 = s * s;
    weight = {s2 * s * T(1.0 / 6.0), T(2.0 / 3.0) - t2 * (T(1.0) - t * T(0.5)),
              T(2.0 / 3.0) - s2 * (T(1.0) - s * T(0.5)), t2 * t * T(1.0 / 6.0)};
  }

  T operator()(const Curve& curve) const {
    return weight[0] * T(curve[first]) + weight[1] * T(curve[first + 1]) +
           weight[2] * T(curve[first + 2]) + weight[3] * T(curve[first + 3]);
  }
};

}  // namespace sulcus::molar
