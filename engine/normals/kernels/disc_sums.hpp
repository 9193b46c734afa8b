// Sums over the disc of a map and its halves, rows of sixteen lanes, i = -8 to 7, whatever the
// map's: loops of map_kernels.hpp, as surface_group.hpp.

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

struct DiscMasks {
  static constexpr int kRows = 2 * kDiscReach + 1;
  alignas(32) int half[kHalves][kRows][16];  // -1: in it
  std::uint16_t bits[kHalves][kRows];
};
constexpr DiscMasks make_disc_masks() {
  DiscMasks masks{};
  constexpr int kRays[kHalves][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                     {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  for (int d = 0; d < kHalves; ++d) {
    for (int row = 0; row < DiscMasks::kRows; ++row) {
      for (int lane = 0; lane < 16; ++lane) {
        const int i = lane - 8, j = row - kDiscReach;
        const bool in_disc = static_cast<float>(i * i + j * j) <= kDiscRadius * kDiscRadius;
        const bool in_half = i * kRays[d][0] + j * kRays[d][1] >= 0;
        if (!in_disc || !in_half) continue;
        masks.half[d][row][lane] = -1;
        masks.bits[d][row] = static_cast<std::uint16_t>(masks.bits[d][row] | 1 << lane);
      }
    }
  }
  return masks;
}
inline constexpr DiscMasks kDiscMasks = make_disc_masks();

inline RowMask in_half(int half, int row, [[maybe_unused]] int lane) {
#ifdef __AVX512F__
  return kDiscMasks.bits[half][row];
#else
  return load(kDiscMasks.half[half][row] + lane);
#endif
}

/// Calls `each(found, x, y, twice z, row)` for the pixels of the disc's rows, from a lane on,
/// one row after the other.
template <class Each>
inline void for_disc(const HeightMap& map, int lane, const Each& each) {
  const int reach = map.ns < kDiscReach ? map.ns : kDiscReach;
  const auto twice_sign = static_cast<float>(2 * map.sign);
  const RowLanes x = kLaneIndex + static_cast<float>(lane - 8);
  const signed char* row =
      map.height.data() + (map.ns - reach) * map.lanes + map.lanes / 2 - 8 + lane;
  for (int j = -reach; j <= reach; ++j, row += map.lanes) {
    const RowLanes height = heights(row);
    each(above(height, static_cast<float>(HeightMap::kNone)), x, static_cast<float>(j),
         height * twice_sign + 1.0f, j + kDiscReach);
  }
}

/// Of nine sums in the order of PlaneSums.
inline PlaneSums plane_sums(const std::array<Lanes, 9>& nine) {
  const std::array<float, 9> s = sum_all(nine);
  return {s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8]};
}

/// Whole numbers: exact in any order.
struct LaneSums9 {
  RowLanes n{}, i{}, j{}, ii{}, ij{}, jj{}, z{}, iz{}, jz{};

  void add(const RowMask& mask, const RowLanes& x, float y, const RowLanes& z2) {
    const RowLanes one = where(mask, RowLanes{} + 1.0f), mi = where(mask, x), mz = where(mask, z2);
    const RowLanes mj = one * y;
    n += one, i += mi, j += mj, ii += mi * x, ij += mi * y, jj += mj * y;
    z += mz, iz += mz * x, jz += mz * y;
  }
  PlaneSums total() const {
    return plane_sums(std::array{halves_of(n), halves_of(i), halves_of(j), halves_of(ii),
                                 halves_of(ij), halves_of(jj), halves_of(z), halves_of(iz),
                                 halves_of(jz)});
  }
};

inline void close_sums(const HeightMap& map, PlaneSums& sums) noexcept {
  constexpr int kReach = 3;
  constexpr float kReach4 = 4.0f * kCloseRadius * kCloseRadius;
  const int reach = map.ns < kReach ? map.ns : kReach;
  const auto twice_sign = static_cast<float>(2 * map.sign);
  LaneSums9 s;
  const RowLanes x = kLaneIndex - static_cast<float>(kReach);
  // Beyond i = 4 there may be columns of the next row.
  const RowLanes four_xx = 4.0f * x * x;
  const signed char* row =
      map.height.data() + (map.ns - reach) * map.lanes + map.lanes / 2 - kReach;
  for (int j = -reach; j <= reach; ++j, row += map.lanes) {
    const auto y = static_cast<float>(j);
    const RowLanes z2 = heights(row) * twice_sign + 1.0f;
    // kNone is far out of it.
    s.add(at_most(four_xx + 4.0f * y * y + z2 * z2, kReach4), x, y, z2);
  }
  sums = s.total();
}

inline void half_sums(const HeightMap& map, std::array<PlaneSums, kHalves>& sums) noexcept {
  for (int d = 0; d < kHalves; ++d) {
    LaneSums9 s;
    for (int lane = 0; lane < 16; lane += kRowStep) {
      for_disc(map, lane,
               [&](const RowMask& found, const RowLanes& x, float y, const RowLanes& z2, int row) {
                 s.add(bits_and(found, in_half(d, row, lane)), x, y, z2);
               });
    }
    sums[static_cast<std::size_t>(d)] = s.total();
  }
}

inline RowLanes residual_across(const HeightPlane& plane, const RowLanes& x, float y,
                                const RowLanes& z2) {
  return (z2 * 0.5f - plane.c0 - (plane.c1 * x + plane.c2 * y)) * plane.cosine;
}

inline void sums_on_plane(const HeightMap& map, int half, const HeightPlane& plane,
                          PlaneSums& sums) noexcept {
  LaneSums9 s;
  for (int lane = 0; lane < 16; lane += kRowStep) {
    for_disc(map, lane,
             [&](const RowMask& found, const RowLanes& x, float y, const RowLanes& z2, int row) {
               const RowMask on = at_most(abs(residual_across(plane, x, y, z2)), plane.slack);
               s.add(bits_and(bits_and(found, on), in_half(half, row, lane)), x, y, z2);
             });
  }
  sums = s.total();
}

inline void residuals_on_plane(const HeightMap& map, int half, const HeightPlane& first,
                               const HeightPlane& plane, Residuals& residuals) noexcept {
  RowLanes largest{};
  Lanes total{};
  for (int lane = 0; lane < 16; lane += kRowStep) {
    RowLanes squares{};
    for_disc(map, lane,
             [&](const RowMask& found, const RowLanes& x, float y, const RowLanes& z2, int row) {
               const RowMask on = at_most(abs(residual_across(first, x, y, z2)), first.slack);
               const RowLanes r = where(bits_and(bits_and(found, on), in_half(half, row, lane)),
                                        residual_across(plane, x, y, z2));
               largest = larger(largest, abs(r));
               squares += r * r;
             });
    add_row(total, squares);
  }
  residuals.largest = largest_of(largest);
  residuals.sum_squares = sum_of(total);
}

}  // namespace

}  // namespace sulcus
