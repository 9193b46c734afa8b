#include <algorithm>
#include <cstdlib>

#include "engine/normals/map_kernels.hpp"
#include "engine/normals/tilted_points.inl"

namespace sulcus {

namespace {

constexpr int kNowhere = 127;  // beyond every window: a column that starts there finds nothing

/// Height of the surface in a column next to one at height `from`.
int follow(std::uint32_t surface, int from, int outward) {
  const int lowest = kLevel + from - kMaxStep;  // of the five that it may step to
  if (lowest < 0 || lowest > 31) return kNowhere;
  for (const int step : {0, outward, -outward, 2 * outward, -2 * outward}) {
    if ((surface >> lowest >> (kMaxStep + step) & 1u) != 0) return from + step;
  }
  return kNowhere;
}

/// Rings from the middle within which no pixel is bad.
template <class Bad>
int rings_without(const HeightMap& map, const Bad& bad) {
  int rings = map.ns;
  for (int j = -map.ns; j <= map.ns; ++j) {
    for (int i = -map.ns; i <= map.ns; ++i) {
      if (bad(i, j)) rings = std::min(rings, std::max(std::abs(i), std::abs(j)) - 1);
    }
  }
  return rings;
}

void trace_map(const ColumnBits::Windows& columns, int trace, HeightMap& map) noexcept {
  const int ns = map.ns;
  map.lanes = lanes_of(ns);
  std::array<int, HeightMap::kMaxRows * HeightMap::kMaxLanes> traced;
  const auto height = [&](int i, int j) -> int& {
    return traced[static_cast<std::size_t>(map.place(i, j))];
  };
  const auto trace_column = [&](int i, int j, int from) {
    const auto w = static_cast<std::uint32_t>(columns.window(i * map.stride, j * map.stride));
    height(i, j) = follow(map.sign > 0 ? w & ~(w >> 1) : w & ~(w << 1), from, map.sign);
  };
  trace_column(0, 0, 0);
  for (int i = 1; i <= ns; ++i) {
    trace_column(i, 0, height(i - 1, 0));
    trace_column(-i, 0, height(1 - i, 0));
  }
  for (int j = 1; j <= ns; ++j) {
    for (int i = -ns; i <= ns; ++i) {
      trace_column(i, j, height(i, j - 1));
      trace_column(i, -j, height(i, 1 - j));
    }
  }
  map.height.fill(HeightMap::kNone);
  for (int j = -ns; j <= ns; ++j) {
    for (int i = -ns; i <= ns; ++i) {
      if (std::abs(height(i, j)) > trace) continue;
      map.height[static_cast<std::size_t>(map.place(i, j))] =
          static_cast<signed char>(height(i, j));
    }
  }
  map.whole_rings =
      rings_without(map, [&](int i, int j) { return map.at(i, j) == HeightMap::kNone; });
  const int centre = map.at(0, 0);
  map.even_rings = rings_without(map, [&](int i, int j) {
    const int a = map.at(i, j), b = map.at(-i, -j);
    return a == HeightMap::kNone || b == HeightMap::kNone ||
           std::abs(a + b - 2 * centre) > kMaxUneven;
  });
}

void fit_map(const HeightMap& map, const QuadricFilter& filter, Quadric& quadric) noexcept {
  const signed char* height = map.height.data() + (map.ns - filter.rings) * map.lanes;
  const int count = (2 * filter.rings + 1) * map.lanes;
  for (std::size_t f = 0; f < kQuadric; ++f) {
    std::int32_t sum = 0;
    for (int k = 0; k < count; ++k) {
      sum += height[k] * filter.coefficient[f][static_cast<std::size_t>(k)];
    }
    quadric[f] = static_cast<float>(map.sign) * (filter.scale[f] * static_cast<float>(sum));
  }
  quadric[0] += 0.5f;
}

constexpr MapKernels kPlain{"plain",          trace_map,      fit_map,         surfaces_of,
                            largest_residual, half_sums,      sums_on_plane,   residuals_on_plane,
                            gather_points,    tilted_moments, tilted_residuals};

}  // namespace

const MapKernels& plain_map_kernels() noexcept { return kPlain; }

const MapKernels& map_kernels() noexcept {
  static const MapKernels& fastest = avx2_map_kernels() ? *avx2_map_kernels() : kPlain;
  return fastest;
}

}  // namespace sulcus
