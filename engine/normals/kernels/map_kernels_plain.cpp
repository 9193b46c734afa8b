#include <algorithm>
#include <bit>
#include <cstdlib>
#include <iterator>

#include "engine/normals/kernels/kernel_table.hpp"
#include "engine/normals/kernels/trace_window.hpp"

namespace sulcus {

namespace {

inline void coarse_sums_of(const ColumnBits::Windows& rows, std::array<std::int32_t, 3>& sums) {
  sums = {};
  for (int k = -2; k <= 2; ++k) {
    for (int j = -2; j <= 2; ++j) {
      const std::uint64_t window = rows.window(j, k);
      for (int i = -2; i <= 2; ++i) {
        const int d2 = i * i + j * j + k * k;
        if (d2 > 6 || (window >> (i + 2) & 1) == 0) continue;  // 6 < 2.5^2 < 7
        const int weight = kCoarseWeight[static_cast<std::size_t>(d2)];
        sums[0] += i * weight;
        sums[1] += j * weight;
        sums[2] += k * weight;
      }
    }
  }
}

void coarse_sums(const ColumnBits::Windows* rows, std::size_t count,
                 std::array<std::int32_t, 3>* sums) noexcept {
  for (std::size_t k = 0; k < count; ++k) coarse_sums_of(rows[k], sums[k]);
}

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

/// Even rings, from what lies within rings whose heights are out of line by no more than a bound.
template <class Within>
int rings_even_within(const Within& within) {
  const int of_many = within(kMostUnevenOfMany);
  return of_many >= kManyRings ? of_many : std::min(within(kMostUneven), kManyRings - 1);
}
int even_rings(const HeightMap& map) {
  const int centre = map.at(0, 0);
  return rings_even_within([&](int most) {
    return rings_without(map, [&](int i, int j) {
      const int a = map.at(i, j), b = map.at(-i, -j);
      return a == HeightMap::kNone || b == HeightMap::kNone || std::abs(a + b - 2 * centre) > most;
    });
  });
}

using TracedHeights = std::array<int, HeightMap::kMaxRows * HeightMap::kMaxLanes>;

/// Traces first along the rows, or with `exchanged` first along the columns.
void trace_first_along(bool exchanged, const ColumnBits::Windows& columns, const HeightMap& map,
                       TracedHeights& traced) {
  const int ns = map.ns;
  const auto height = [&](int along, int across) -> int& {
    const int place = exchanged ? map.place(across, along) : map.place(along, across);
    return traced[static_cast<std::size_t>(place)];
  };
  const auto trace_column = [&](int along, int across, int from) {
    const int i = exchanged ? across : along, j = exchanged ? along : across;
    const auto w = static_cast<std::uint32_t>(columns.window(i * map.stride, j * map.stride));
    const std::uint32_t surface = (map.sign > 0 ? w & ~(w >> 1) : w & ~(w << 1)) & kTraceable;
    height(along, across) = follow(surface, from, map.sign);
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
}

void trace_map(const ColumnBits::Windows& columns, int trace, HeightMap& map) {
  const int ns = map.ns;
  map.lanes = lanes_of(ns);
  TracedHeights traced, exchanged;
  trace_first_along(map.order == TraceOrder::kColumnFirst, columns, map, traced);
  if (map.order == TraceOrder::kBoth) trace_first_along(true, columns, map, exchanged);
  map.height.fill(HeightMap::kNone);
  for (int j = -ns; j <= ns; ++j) {
    for (int i = -ns; i <= ns; ++i) {
      const auto place = static_cast<std::size_t>(map.place(i, j));
      if (std::abs(traced[place]) > trace) continue;
      if (map.order == TraceOrder::kBoth && traced[place] != exchanged[place]) continue;
      map.height[place] = static_cast<signed char>(traced[place]);
    }
  }
  map.whole_rings =
      rings_without(map, [&](int i, int j) { return map.at(i, j) == HeightMap::kNone; });
  map.even_rings = even_rings(map);
}

void trace_maps(const ColumnBits::Windows* columns, std::size_t count, int trace,
                HeightMap* maps) noexcept {
  for (std::size_t k = 0; k < count; ++k) trace_map(columns[k], trace, maps[k]);
}

void fit_rows(const signed char* middle, std::ptrdiff_t pitch, const QuadricFilter& filter,
              QuadricSums& sums) noexcept {
  for (std::size_t f = 0; f < kQuadric; ++f) {
    sums[f] = 0;
    const std::int16_t* coefficient = filter.coefficient[f].data();
    for (int j = -filter.rings; j <= filter.rings; ++j, coefficient += filter.lanes) {
      const signed char* height = middle + j * pitch;
      for (int lane = 0; lane < filter.lanes; ++lane) sums[f] += height[lane] * coefficient[lane];
    }
  }
}

/// Height of the one surface in a column's window, as a tile keeps it.
signed char tile_height(std::uint32_t window, int sign) {
  const std::uint32_t surface = (sign > 0 ? window & ~(window >> 1) : window & ~(window << 1)) &
                                0x7ffffffeu;  // at the ends the next voxel is not known
  if (std::popcount(surface) != 1) return HeightMap::kNone;
  const int height = std::countr_zero(surface) - HeightTile::kBelow;
  const bool kept = height >= HeightTile::kLowest && height <= HeightTile::kHighest;
  return kept ? static_cast<signed char>(height) : HeightMap::kNone;
}

void read_tile(const ColumnBits::Windows& columns, HeightTile& tile) noexcept {
  const int ns = tile.ns;
  for (auto& row : tile.height) std::fill(std::begin(row), std::end(row), HeightMap::kNone);
  for (int v = -ns; v < HeightTile::kEdge + ns; ++v) {
    for (int u = -HeightTile::kMargin; u < HeightTile::kEdge + HeightTile::kMargin; ++u) {
      const auto window = static_cast<std::uint32_t>(columns.window(u, v));
      tile.height[ns + v][HeightTile::kMargin + u] = tile_height(window, tile.sign);
    }
  }
  const auto follows = [&](int u, int v, int from_u, int from_v) {
    return std::abs(tile.at(u, v) - tile.at(from_u, from_v)) <= kMaxStep;
  };
  const auto sound = [&](int u, int v) {
    for (int j = -ns; j <= ns; ++j) {
      for (int i = -ns; i <= ns; ++i) {
        if (tile.at(u + i, v + j) == HeightMap::kNone) return false;
        if (j > -ns && !follows(u + i, v + j, u + i, v + j - 1)) return false;
        if (i > -ns && !follows(u + i, v + j, u + i - 1, v + j)) return false;
      }
    }
    return true;
  };
  const QuadricFilter& filter = quadric_filter(ns, lanes_of(ns));
  for (int v = 0; v < HeightTile::kEdge; ++v) {
    tile.sound[v] = 0;
    for (int u = 0; u < HeightTile::kEdge; ++u) {
      for (auto& sums : tile.sums[v]) sums[u] = 0;
      tile.columns[v * HeightTile::kEdge + u] = HeightTile::kUnsound;
      if (!sound(u, v)) continue;
      tile.sound[v] = static_cast<std::uint8_t>(tile.sound[v] | 1 << u);
      int highest = tile.at(u, v), lowest = highest;
      const int even = rings_even_within([&](int most) {
        int rings = ns;
        for (int j = -ns; j <= ns; ++j) {
          for (int i = -ns; i <= ns; ++i) {
            const int height = tile.at(u + i, v + j), opposite = tile.at(u - i, v - j);
            highest = std::max(highest, height);
            lowest = std::min(lowest, height);
            if (std::abs(height + opposite - 2 * tile.at(u, v)) > most) {
              rings = std::min(rings, std::max(std::abs(i), std::abs(j)) - 1);
            }
          }
        }
        return rings;
      });
      tile.columns[v * HeightTile::kEdge + u] = {
          static_cast<signed char>(tile.at(u, v)), static_cast<signed char>(highest),
          static_cast<signed char>(lowest), static_cast<std::uint8_t>(even)};
      for (std::size_t f = 0; f < kQuadric; ++f) {
        for (int j = -ns; j <= ns; ++j) {
          for (int i = -ns; i <= ns; ++i) {
            const auto place =
                static_cast<std::size_t>((ns + j) * filter.lanes + filter.lanes / 2 + i);
            tile.sums[v][f][u] += filter.coefficient[f][place] * tile.at(u + i, v + j);
          }
        }
      }
    }
  }
}

bool cut_map(const HeightTile& tile, int u, int v, int w, int trace, HeightMap& map) noexcept {
  if (!tile.is_sound(u, v) || std::abs(tile.at(u, v) - w) > kMaxStep) return false;
  const int ns = tile.ns, reach = std::min(trace, HeightTile::kReach);
  map.lanes = lanes_of(ns);
  map.height.fill(HeightMap::kNone);
  for (int j = -ns; j <= ns; ++j) {
    for (int i = -ns; i <= ns; ++i) {
      const int height = tile.at(u + i, v + j) - w;
      if (std::abs(height) > reach) return false;
      map.height[static_cast<std::size_t>(map.place(i, j))] = static_cast<signed char>(height);
    }
  }
  map.whole_rings = ns;
  map.even_rings = even_rings(map);
  return true;
}

constexpr MapKernels kPlain = kernel_table("plain", {.coarse = coarse_sums,
                                                     .trace = trace_maps,
                                                     .tile = read_tile,
                                                     .cut = cut_map,
                                                     .fit = fit_rows});

}  // namespace

const MapKernels* map_kernels_of(InstructionSet set) noexcept {
  return kernels_of<MapKernels>(set, {&kPlain, avx2_map_kernels(), avx512_map_kernels()});
}

const MapKernels& map_kernels() noexcept {
  static const MapKernels& fastest = fastest_kernels(map_kernels_of);
  return fastest;
}

}  // namespace sulcus
