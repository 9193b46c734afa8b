#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// Values on a box of lattice points, x fastest: what importers work on before there are voxels.
template <class T>
struct Lattice {
  Eigen::Vector3i sizes = Eigen::Vector3i::Zero();
  std::vector<T> values;

  Lattice() = default;
  Lattice(const Eigen::Vector3i& box, T value)
      : sizes(box), values(static_cast<std::size_t>(box.cast<std::ptrdiff_t>().prod()), value) {}

  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(sizes.x()) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(sizes.y()) * static_cast<std::size_t>(k));
  }
  T& at(int i, int j, int k) { return values[index(i, j, k)]; }
  const T& at(int i, int j, int k) const { return values[index(i, j, k)]; }
  bool contains(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < sizes.x() && j < sizes.y() && k < sizes.z();
  }
};

/// How values between lattice points follow from those at them. All weights are positive and add
/// up to one, so that a value never leaves the range of the 4 x 4 x 4 points around it.
enum class Interpolation : std::uint8_t {
  kNearest,  // of the lattice point itself: for a grid that is the lattice
  kLinear,   // of the 8 corners: passes through the values, creased at each of them
  kSpline,   // cubic B-spline kernel: smooths by a deviation of 0.58 steps, curvature continuous
};

/// Weights of the points at floor(x) - 1, floor(x), floor(x) + 1 and floor(x) + 2 for the fraction
/// t of x.
inline std::array<float, 4> interpolation_weights(Interpolation kind, float t) {
  const float s = 1.0f - t;
  switch (kind) {
    case Interpolation::kNearest:
      return {0.0f, t < 0.5f ? 1.0f : 0.0f, t < 0.5f ? 0.0f : 1.0f, 0.0f};
    case Interpolation::kLinear:
      return {0.0f, s, t, 0.0f};
    case Interpolation::kSpline:
      break;
  }
  const float first = s * s * s / 6.0f;
  const float second = 2.0f / 3.0f - 0.5f * t * t * (2.0f - t);
  const float fourth = t * t * t / 6.0f;
  return {first, second, 1.0f - first - second - fourth, fourth};
}

/// The slopes of kSpline's weights, per step.
inline std::array<float, 4> spline_slopes(float t) {
  const float s = 1.0f - t;
  const float first = -0.5f * s * s, second = t * (1.5f * t - 2.0f), fourth = 0.5f * t * t;
  return {first, second, -first - second - fourth, fourth};
}

}  // namespace sulcus
