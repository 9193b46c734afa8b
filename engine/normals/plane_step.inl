// Steps of a plane over a map, in single precision, written once and compiled for each instruction
// set by the files that include this.

#pragma once

#include "engine/normals/tilted_points.inl"

namespace sulcus {

namespace {

/// The columns of a map by eight of the same row, as seen from a plane. kNone is far from all
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

  /// How far eight columns lie from the plane, across it, and which lie on it.
  struct Eight {
    Lanes residual;
    IntLanes on;
  };
  /// Calls `middle(eight, x)` for the columns of the middle row, `pair(above, below, x, y)` for
  /// those of the rows +y and -y, and `end(x)` after all of the same x.
  template <class Middle, class Pair, class End>
  void walk(const Middle& middle, const Pair& pair, const End& end) const {
    const int mid = map_.lanes / 2;
    for (int group = (mid - map_.ns) / 8; group < (mid + map_.ns) / 8 + 1; ++group) {
      const Lanes x = kAlong + static_cast<float>(8 * group - mid), level = c0_ + c1_ * x;
      const signed char* const row = map_.height.data() + map_.ns * map_.lanes + 8 * group;
      middle(eight(row, level), x);
      for (int j = 1; j <= map_.ns; ++j) {
        const auto y = static_cast<float>(j);
        pair(eight(row + j * map_.lanes, level + c2_ * y),
             eight(row - j * map_.lanes, level - c2_ * y), x, y);
      }
      end(x);
    }
  }

 private:
  Eight eight(const signed char* row, const Lanes& level) const {
    const Lanes r = to_float(heights(row)) * scale_ - level;
    return {r, abs(r) <= slack_};
  }

  const HeightMap& map_;
  float scale_, c0_, c1_, c2_, slack_;
};

struct Weighed {
  Lanes weight, right;
};

/// Sums of a weight and a right side, which `weigh(residual, its square, x^2 + y^2)` gives, over
/// what lies on a plane.
template <class Weigh>
inline void sum_plane(const HeightMap& map, const HeightPlane& plane, const Weigh& weigh,
                      PlaneSums& sums) {
  Lanes n{}, i{}, j{}, ii{}, ij{}, jj{}, z{}, iz{}, jz{};
  // Powers of x wait until the rows are added up.
  Lanes w0{}, w1{}, w2{}, right0{}, right1{};
  using Eight = ColumnsOverPlane::Eight;
  const auto weighed = [&](const Eight& columns, const Lanes& distance2) {
    auto [weight, right] = weigh(columns.residual, columns.residual * columns.residual, distance2);
    return Weighed{where(columns.on, weight), where(columns.on, right)};
  };
  ColumnsOverPlane(map, plane)
      .walk(
          [&](const Eight& columns, const Lanes& x) {
            const Weighed w = weighed(columns, x * x);
            w0 = w.weight, w1 = w2 = right1 = Lanes{}, right0 = w.right;
          },
          [&](const Eight& above, const Eight& below, const Lanes& x, float y) {
            const Lanes distance2 = x * x + y * y;
            const Weighed a = weighed(above, distance2), b = weighed(below, distance2);
            const Lanes both = a.weight + b.weight;
            w0 += both, w1 += (a.weight - b.weight) * y, w2 += both * (y * y);
            right0 += a.right + b.right, right1 += (a.right - b.right) * y;
          },
          [&](const Lanes& x) {
            n += w0, i += w0 * x, ii += w0 * x * x;
            j += w1, ij += w1 * x, jj += w2;
            z += right0, iz += right0 * x, jz += right1;
          });
  sums = {sum_of(n),  sum_of(i), sum_of(j),  sum_of(ii), sum_of(ij),
          sum_of(jj), sum_of(z), sum_of(iz), sum_of(jz)};
}

inline void plane_step(const HeightMap& map, const HeightPlane& plane, PlaneWeight kind,
                       float bound, PlaneSums& sums) noexcept {
  const auto ns = static_cast<float>(map.ns);
  const float fall = 1.0f / (2.5f * ns * ns), bound2 = bound * bound;
  switch (kind) {
    case PlaneWeight::kTaper:
      return sum_plane(
          map, plane,
          [=](const Lanes& r, const Lanes&, const Lanes& distance2) {
            const Lanes weight = 1.0f - fall * distance2;
            return Weighed{weight, weight * r};
          },
          sums);
    case PlaneWeight::kQuartic:
      return sum_plane(
          map, plane,
          [=](const Lanes& r, const Lanes& r2, const Lanes& distance2) {
            const Lanes weight = (1.0f - fall * distance2) * r2;
            return Weighed{weight, weight * r};
          },
          sums);
    case PlaneWeight::kInterior:
      return sum_plane(
          map, plane,
          [=](const Lanes& r, const Lanes& r2, const Lanes&) {
            const Lanes inverse = 1.0f / (bound2 - r2);
            return Weighed{(bound2 + r2) * inverse * inverse, r * inverse};
          },
          sums);
  }
}

inline void look_at_plane(const HeightMap& map, const HeightPlane& plane,
                          PlaneLook& look) noexcept {
  Lanes largest{}, squares{};
  IntLanes count{};
  using Eight = ColumnsOverPlane::Eight;
  const auto take = [&](const Eight& columns) {
    const Lanes size = where(columns.on, abs(columns.residual));
    largest = larger(largest, size);
    squares += size * size;
    count -= columns.on;
  };
  ColumnsOverPlane(map, plane)
      .walk([&](const Eight& columns, const Lanes&) { take(columns); },
            [&](const Eight& above, const Eight& below, const Lanes&, float) {
              take(above);
              take(below);
            },
            [](const Lanes&) {});
  look.residuals = {largest_of(largest), sum_of(squares)};
  look.count = 0;
  for (int lane = 0; lane < 8; ++lane) look.count += count[lane];
}

}  // namespace

}  // namespace sulcus
