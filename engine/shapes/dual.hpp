#pragma once

#include <cmath>

namespace sulcus::molar {

/// A value with its three partial derivatives (forward-mode differentiation): a formula written
/// once for `double` and `Dual` gives a function and its exact gradient.
struct Dual {
  double value = 0.0;
  double dx = 0.0, dy = 0.0, dz = 0.0;

  Dual() = default;
  Dual(double constant) : value(constant) {}  // NOLINT: constants mix freely with variables
  Dual(double v, double x, double y, double z) : value(v), dx(x), dy(y), dz(z) {}

  /// This quantity through an outer function of value `f` and derivative `slope`.
  Dual chain(double f, double slope) const { return {f, slope * dx, slope * dy, slope * dz}; }
};

inline Dual operator-(const Dual& a) { return {-a.value, -a.dx, -a.dy, -a.dz}; }
inline Dual operator+(const Dual& a, const Dual& b) {
  return {a.value + b.value, a.dx + b.dx, a.dy + b.dy, a.dz + b.dz};
}
inline Dual operator-(const Dual& a, const Dual& b) {
  return {a.value - b.value, a.dx - b.dx, a.dy - b.dy, a.dz - b.dz};
}
inline Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.dx * b.value + a.value * b.dx, a.dy * b.value + a.value * b.dy,
          a.dz * b.value + a.value * b.dz};
}
inline Dual operator/(const Dual& a, const Dual& b) {
  const double inverse = 1.0 / b.value, q = a.value * inverse;
  return {q, (a.dx - q * b.dx) * inverse, (a.dy - q * b.dy) * inverse, (a.dz - q * b.dz) * inverse};
}
inline Dual sqrt(const Dual& a) {
  const double root = std::sqrt(a.value);
  return a.chain(root, 0.5 / root);
}

inline double plain(double a) { return a; }
inline double plain(const Dual& a) { return a.value; }

template <class T>
T square(const T& a) {
  return a * a;
}

/// |a| with its corner rounded over a width of about `radius`; never below |a|.
template <class T>
T smooth_abs(const T& a, double radius) {
  using std::sqrt;
  return sqrt(a * a + T(radius * radius));
}

/// The greater of two, the corner rounded where they differ by less than `k` (cubic, twice
/// differentiable); at most k/6 above it. Weights of a and b add up to 1, so a Lipschitz bound of
/// both holds for the result.
template <class T>
T smooth_max(const T& a, const T& b, double k) {
  const T gap = plain(a) > plain(b) ? T(a - b) : T(b - a);
  const T& greater = plain(a) > plain(b) ? a : b;
  if (plain(gap) >= k) return greater;
  const T h = T(1.0) - gap * T(1.0 / k);
  return greater + h * h * h * T(k / 6.0);
}

template <class T>
T smooth_min(const T& a, const T& b, double k) {
  return -smooth_max(T(-a), T(-b), k);
}

/// 1 at 0, falling to 0 at |a| = width and beyond; bell-shaped, twice differentiable.
template <class T>
T bell(const T& a, double width) {
  const T t = square(T(a * T(1.0 / width)));
  if (plain(t) >= 1.0) return T(0.0);
  const T h = T(1.0) - t;
  return h * h * h;
}

/// 0 below `from`, 1 above `to`, smooth between (quintic, twice differentiable).
template <class T>
T smooth_step(const T& a, double from, double to) {
  const T t = (a - T(from)) * T(1.0 / (to - from));
  if (plain(t) <= 0.0) return T(0.0);
  if (plain(t) >= 1.0) return T(1.0);
  return t * t * t * (t * (t * T(6.0) - T(15.0)) + T(10.0));
}

}  // namespace sulcus::molar
