#include "tools/sulcus_lab/fractions/force_grain.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr int kHalfWindow = 20, kFromCorner = 60, kFromAir = 20;  // ticks
constexpr double kAir_N = 0.02;

/// Ticks that no corner and no free air is near.
std::vector<char> even_ticks(std::span<const Vector3d> positions_m,
                             std::span<const Vector3d> forces_N) {
  const int count = static_cast<int>(forces_N.size());
  std::vector<char> even(forces_N.size(), 1);
  const auto leave_out = [&](int tick, int around) {
    std::fill(even.begin() + std::max(0, tick - around),
              even.begin() + std::min(count, tick + around + 1), char{0});
  };
  for (int t = 0; t < count; ++t) {
    const auto at = static_cast<std::size_t>(t);
    if (forces_N[at].norm() < kAir_N) leave_out(t, kFromAir);
    if (t < 2) continue;
    const Vector3d step = positions_m[at] - positions_m[at - 1];
    const Vector3d before = positions_m[at - 1] - positions_m[at - 2];
    if ((step - before).norm() > 1e-9 + 1e-4 * std::max(step.norm(), before.norm())) {
      leave_out(t, kFromCorner);
    }
  }
  return even;
}

/// The quadratic that fits the window around a tick best, at that tick.
Vector3d smoothed(std::span<const Vector3d> forces_N, std::size_t tick) {
  double s0 = 0.0, s2 = 0.0, s4 = 0.0;
  Vector3d sum = Vector3d::Zero(), weighted = Vector3d::Zero();
  for (int x = -kHalfWindow; x <= kHalfWindow; ++x) {
    const Vector3d& force = forces_N[tick + static_cast<std::size_t>(x)];
    const double x2 = static_cast<double>(x) * x;
    s0 += 1.0;
    s2 += x2;
    s4 += x2 * x2;
    sum += force;
    weighted += x2 * force;
  }
  return (s4 * sum - s2 * weighted) / (s0 * s4 - s2 * s2);
}

}  // namespace

ForceGrain force_grain(std::span<const Vector3d> positions_m, std::span<const Vector3d> forces_N) {
  const std::vector<char> even = even_ticks(positions_m, forces_N);
  ForceGrain grain;
  double squares = 0.0;
  for (std::size_t t = kHalfWindow; t + kHalfWindow < forces_N.size(); ++t) {
    const auto first = even.begin() + static_cast<std::ptrdiff_t>(t) - kHalfWindow;
    if (!std::all_of(first, first + 2 * kHalfWindow + 1, [](char e) { return e != 0; })) continue;
    ++grain.ticks;
    grain.mean_N += forces_N[t].norm();
    squares += (forces_N[t] - smoothed(forces_N, t)).squaredNorm();
    grain.largest_step_N = std::max(grain.largest_step_N, (forces_N[t + 1] - forces_N[t]).norm());
  }
  if (grain.ticks == 0) return {};
  grain.mean_N /= grain.ticks;
  grain.grain_pct = 100.0 * std::sqrt(squares / grain.ticks) / grain.mean_N;
  return grain;
}

}  // namespace sulcus::lab
