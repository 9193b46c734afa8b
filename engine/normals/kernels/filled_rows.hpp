// The rows of filled maps, and points over their sides: loops of map_kernels.hpp. Whole numbers, or
// the same operations on every lane, so that a compiler may lay them side by side as it likes.

#pragma once

#include "engine/normals/filled_map.hpp"
#include "engine/normals/kernels/tilted_points.hpp"
#include "engine/normals/quadric_filter.hpp"

namespace sulcus {

namespace {

/// Sixteen columns of a row.
using ShortLanes = std::int16_t __attribute__((vector_size(32)));
using ByteLanes = signed char __attribute__((vector_size(16)));
inline ShortLanes load_shorts(const std::int16_t* p) {
  ShortLanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline ShortLanes load_bytes(const signed char* p) {
  ByteLanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return __builtin_convertvector(v, ShortLanes);
}
inline bool has_any(const ShortLanes& v) {
  std::uint64_t words[4];
  __builtin_memcpy(words, &v, sizeof v);
  return (words[0] | words[1] | words[2] | words[3]) != 0;
}

inline std::uint32_t fill_rows(const HeightMap& traced, std::uint32_t rows, const std::int16_t* top,
                               const std::int16_t* lack, int level, int sign,
                               FilledMap& map) noexcept {
  constexpr ShortLanes kLane = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const auto all = [](int v) { return ShortLanes{} + static_cast<std::int16_t>(v); };
  const ShortLanes none = all(FilledMap::kNone), not_traced = all(HeightMap::kNone),
                   no_lack = all(ColumnLacks::kUnknown), at = all(level),
                   per_voxel = all(sign * kHeightParts), half = all(kHeightParts / 2);
  const int ns = traced.ns, lanes = traced.lanes;
  const signed char* const heights = &traced.height.front();
  std::int16_t* const out = &map.height.front();
  std::uint32_t unknown_rows = 0;
  for (std::uint32_t rest = rows; rest != 0; rest &= rest - 1) {
    const int row = __builtin_ctz(rest);
    ShortLanes unknown{}, parts{}, holes{};
    for (int lane = 0; lane < lanes; lane += 16) {
      const ShortLanes h = load_bytes(heights + row * lanes + lane);
      const ShortLanes l = load_shorts(lack + row * ColumnLacks::kLanes + lane);
      const ShortLanes t = load_shorts(top + row * ColumnLacks::kLanes + lane);
      const ShortLanes is_traced = h != not_traced, found = is_traced & (l != no_lack);
      const ShortLanes i = kLane + static_cast<std::int16_t>(lane - lanes / 2);
      unknown |= is_traced & (t != h + at);
      parts |= found & (l != 0);
      holes |= ~found & (i >= all(-ns)) & (i <= all(ns));
      const ShortLanes above = ((h * per_voxel + half - l) & found) | (none & ~found);
      __builtin_memcpy(out + row * lanes + lane, &above, sizeof above);
    }
    const std::uint32_t bit = std::uint32_t{1} << row;
    map.holes = has_any(holes) ? map.holes | bit : map.holes & ~bit;
    map.parts = has_any(parts) ? map.parts | bit : map.parts & ~bit;
    if (has_any(unknown)) unknown_rows |= bit;
  }
  return unknown_rows;
}

inline void filled_sums(const FilledMap& map, const QuadricFilter& filter,
                        std::int64_t* sums) noexcept {
  // Up to this neighbourhood the sums of a row stay below 2^31.
  constexpr int kMostNarrow = 10;
  const int lanes = map.lanes;
  const std::int16_t centre = map.height.begin()[map.ns * lanes + lanes / 2];
  for (int f = 0; f < kQuadric; ++f) sums[f] = 0;
  for (int row = 0; row <= 2 * map.ns; ++row) {
    const std::int16_t* heights = map.height.begin() + row * lanes;
    alignas(64) std::int16_t above[HeightMap::kMaxLanes];
    for (int lane = 0; lane < lanes; lane += 16) {
      const ShortLanes v = load_shorts(heights + lane) - centre;
      __builtin_memcpy(above + lane, &v, sizeof v);
    }
    for (int f = 0; f < kQuadric; ++f) {
      const std::int16_t* factors = filter.coefficient.begin()[f].begin() + row * lanes;
      if (map.ns <= kMostNarrow) {
        std::int32_t sum = 0;
        for (int lane = 0; lane < lanes; ++lane) sum += factors[lane] * above[lane];
        sums[f] += sum;
      } else {
        for (int lane = 0; lane < lanes; ++lane) sums[f] += factors[lane] * above[lane];
      }
    }
  }
}

inline float filled_residual(const FilledMap& map, const ColumnQuadric& q) noexcept {
  const int lanes = map.lanes, middle = lanes / 2, first = (middle - map.ns) & -kRowStep;
  constexpr float kPerPart = 1.0f / kHeightParts;
  const float* const c = q.c.begin();
  RowLanes largest{};
  for (int j = -map.ns; j <= map.ns; ++j) {
    const std::int16_t* row = map.height.begin() + (map.ns + j) * lanes;
    const auto y = static_cast<float>(j);
    const float y1 = c[2] * y, y2 = c[5] * y * y, xy = c[4] * y, ty = q.t_y * y;
    for (int lane = first; lane <= middle + map.ns; lane += kRowStep) {
      // What x and y have in common is added up first, as in column_quadric.hpp.
      const RowLanes x = kLaneIndex + static_cast<float>(lane - middle);
      const RowLanes z2 = (c[3] * x * x + y2) + xy * x, t = q.t_x * x + ty;
      const RowLanes z = c[0] + (c[1] * x + y1) + z2 * (1.0f + t + t * t) + q.quartic * (z2 * z2);
      const RowLanes off = heights(row + lane) * kPerPart - z;
      const auto within = static_cast<float>(map.ns);
      largest = larger(largest, where(at_most(abs(x), within), abs(off)));
    }
  }
  return largest_of(largest);
}

inline void gather_filled(const FilledMap& map, const TiltedFrame& frame,
                          TiltedPoints& points) noexcept {
  constexpr float kPerPart = 1.0f / kHeightParts;
  gather<false>(
      map, frame, [](const std::int16_t* row) { return heights(row) * kPerPart; }, points);
}

inline SidePoints take_side(const TiltedPoints& all, const std::array<float, 3>& across,
                            float least, float* weights) noexcept {
  constexpr float kBeyond = 64.0f;  // what any point is on either side of the rim
  const float* const a = across.begin();
  RowLanes farthest{}, nearest{};
  SidePoints side;
  for (int k = 0; k < all.count; k += kRowStep) {
    const RowLanes weight = load_row(all.weight + k);
    const RowLanes out =
        load_row(all.u + k) * a[0] + load_row(all.w + k) * a[1] + load_row(all.n + k) * a[2];
    const RowMask in = bits_and(above(weight, 0.0f), above(out, least));
    store_row(where(in, weight), weights + k);
    side.count += count_of(in);
    farthest = larger(farthest, where(in, kBeyond + out));
    nearest = larger(nearest, where(in, kBeyond - out));
  }
  side.width = largest_of(farthest) + largest_of(nearest) - 2.0f * kBeyond;
  return side;
}

}  // namespace

}  // namespace sulcus
