// Steps of a plane over a map, in single precision, written once and compiled for each instruction
// set by the files that include this.

#pragma once

#include "engine/normals/kernels/disc_sums.hpp"

namespace sulcus {

namespace {

/// The columns of a map by rows, or parts of them, as seen from a plane. kNone is far from all
/// planes whose cosine to the columns is at least kLeastPlaneCosine.
class ColumnsOverPlane {
 public:
  ColumnsOverPlane(const HeightMap& map, const HeightPlane& plane)
      : map_(map),
        scale_(plane.cosine * static_cast<float>(map.sign)),
        c0_((plane.c0 - 0.5f) * plane.cosine),
        c1_(plane.c1 * plane.cosine),
        c2_(plane.c2 * plane.cosine),
        slack_(plane.slack) {}

  /// How far columns lie from the plane, across it, and which lie on it.
  struct Seen {
    RowLanes residual;
    RowMask on;
  };
  /// Calls `middle(seen, x)` for the columns of the middle row, `pair(above, below, x, y)` for
  /// those of the rows +y and -y, and `end(x)` after all of the same x.
  template <class Middle, class Pair, class End>
  void walk(const Middle& middle, const Pair& pair, const End& end) const {
    const int mid = map_.lanes / 2;
    for (int at = (mid - map_.ns) & -kRowStep; at <= mid + map_.ns; at += kRowStep) {
      const RowLanes x = kLaneIndex + static_cast<float>(at - mid), level = c0_ + c1_ * x;
      const signed char* const row = map_.height.data() + map_.ns * map_.lanes + at;
      middle(seen(row, level), x);
      for (int j = 1; j <= map_.ns; ++j) {
        const auto y = static_cast<float>(j);
        pair(seen(row + j * map_.lanes, level + c2_ * y),
             seen(row - j * map_.lanes, level - c2_ * y), x, y);
      }
      end(x);
    }
  }

 private:
  Seen seen(const signed char* row, const RowLanes& level) const {
    const RowLanes r = heights(row) * scale_ - level;
    return {r, at_most(abs(r), slack_)};
  }

  const HeightMap& map_;
  float scale_, c0_, c1_, c2_, slack_;
};

struct Weighed {
  RowLanes weight, right;
};

/// Sums of a weight and a right side, which `weigh(residual, its square, x^2 + y^2)` gives, over
/// what lies on a plane.
template <class Weigh>
inline void sum_plane(const HeightMap& map, const HeightPlane& plane, const Weigh& weigh,
                      PlaneSums& sums) {
  Lanes n{}, i{}, j{}, ii{}, ij{}, jj{}, z{}, iz{}, jz{};
  // Powers of x wait until the rows are added up.
  RowLanes w0{}, w1{}, w2{}, right0{}, right1{};
  using Seen = ColumnsOverPlane::Seen;
  const auto weighed = [&](const Seen& columns, const RowLanes& distance2) {
    auto [weight, right] = weigh(columns.residual, columns.residual * columns.residual, distance2);
    return Weighed{where(columns.on, weight), where(columns.on, right)};
  };
  ColumnsOverPlane(map, plane)
      .walk(
          [&](const Seen& columns, const RowLanes& x) {
            const Weighed w = weighed(columns, x * x);
            w0 = w.weight, w1 = w2 = right1 = RowLanes{}, right0 = w.right;
          },
          [&](const Seen& above, const Seen& below, const RowLanes& x, float y) {
            const RowLanes distance2 = x * x + y * y;
            const Weighed a = weighed(above, distance2), b = weighed(below, distance2);
            const RowLanes sum = a.weight + b.weight;
            w0 += sum, w1 += (a.weight - b.weight) * y, w2 += sum * (y * y);
            right0 += a.right + b.right, right1 += (a.right - b.right) * y;
          },
          [&](const RowLanes& x) {
            add_row(n, w0), add_row(i, w0 * x), add_row(ii, w0 * x * x);
            add_row(j, w1), add_row(ij, w1 * x), add_row(jj, w2);
            add_row(z, right0), add_row(iz, right0 * x), add_row(jz, right1);
          });
  sums = plane_sums({n, i, j, ii, ij, jj, z, iz, jz});
}

inline void plane_step(const HeightMap& map, const HeightPlane& plane, PlaneWeight kind,
                       float bound, PlaneSums& sums) noexcept {
  const auto ns = static_cast<float>(map.ns);
  const float fall = 1.0f / (2.5f * ns * ns), bound2 = bound * bound;
  switch (kind) {
    case PlaneWeight::kWindow:
      return sum_plane(
          map, plane,
          [=](const RowLanes& r, const RowLanes&, const RowLanes& distance2) {
            const RowLanes weight = 1.0f - fall * distance2;
            return Weighed{weight, weight * r};
          },
          sums);
    case PlaneWeight::kQuartic:
      return sum_plane(
          map, plane,
          [=](const RowLanes& r, const RowLanes& r2, const RowLanes& distance2) {
            const RowLanes weight = (1.0f - fall * distance2) * r2;
            return Weighed{weight, weight * r};
          },
          sums);
    case PlaneWeight::kInterior:
      return sum_plane(
          map, plane,
          [=](const RowLanes& r, const RowLanes& r2, const RowLanes&) {
            const RowLanes inverse = 1.0f / (bound2 - r2);
            return Weighed{(bound2 + r2) * inverse * inverse, r * inverse};
          },
          sums);
  }
}

inline void look_at_plane(const HeightMap& map, const HeightPlane& plane,
                          PlaneLook& look) noexcept {
  RowLanes largest{}, squares{};
  Lanes total{};
  int count = 0;
  using Seen = ColumnsOverPlane::Seen;
  const auto take = [&](const Seen& columns) {
    const RowLanes size = where(columns.on, abs(columns.residual));
    largest = larger(largest, size);
    squares += size * size;
    count += count_of(columns.on);
  };
  ColumnsOverPlane(map, plane)
      .walk(
          [&](const Seen& columns, const RowLanes&) {
            squares = RowLanes{};
            take(columns);
          },
          [&](const Seen& above, const Seen& below, const RowLanes&, float) {
            take(above);
            take(below);
          },
          [&](const RowLanes&) { add_row(total, squares); });
  look = {{largest_of(largest), sum_of(total)}, count};
}

}  // namespace

}  // namespace sulcus
