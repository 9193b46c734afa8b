// The filters' sums of all maps of a leaf's tile, for AVX2 and AVX-512.

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// The words of a tile's rows: columns -8 to -1, 0 to 7, 8 to 15.
struct TileWords {
  static constexpr int kRoom = (HeightTile::kRows + 3) / 4 * 4;  // rows are read by fours
  std::uint64_t of[3][kRoom];
};

/// Sums over a row of i^a times height, for the eight columns of the leaf.
struct RowMoments {
  alignas(32) std::int32_t of[5][TileWords::kRoom][HeightTile::kEdge];
};

/// Several rows at a time: the heights i to either side are added, and subtracted, and taken in
/// pairs.
template <int kPairs>
inline void row_moments(const TileWords& words, int ns, RowMoments& moments) {
  std::int16_t factor[5][kPairs][2];
  for (int pair = 0; pair < kPairs; ++pair) {
    for (int half = 0; half < 2; ++half) {
      const int i = 2 * pair + 1 + half;
      int power = i <= ns ? 1 : 0;
      for (int a = 0; a < 5; ++a, power *= i)
        factor[a][pair][half] = static_cast<std::int16_t>(power);
    }
  }
  const auto factors = [&](int a, int pair) {
    std::int32_t two;
    __builtin_memcpy(&two, factor[a][pair], sizeof two);
    return both_factors(two);
  };
  const RowPairs none = both_factors(0);
  for (int r = 0; r < HeightTile::kEdge + 2 * ns; r += kMomentRows) {
    const auto at = [&](int i) {
      const std::uint64_t* const from = words.of[i < 0 ? 0 : 1] + r;
      return columns_from(from, from + TileWords::kRoom, i & 7);
    };
    RowPairs low[5], high[5];
    const RowPairs middle = at(0);
    for (int a = 0; a < 5; ++a) low[a] = high[a] = none;
    low[0] = add_pairs(none, low_pairs(middle, none), both_factors(1));
    high[0] = add_pairs(none, high_pairs(middle, none), both_factors(1));
#pragma GCC unroll 4
    for (int pair = 0; pair < kPairs; ++pair) {
      const int i = 2 * pair + 1;
      const RowPairs right0 = at(i), left0 = at(-i), right1 = at(i + 1), left1 = at(-i - 1);
      const RowPairs even0 = sum16(right0, left0), odd0 = difference16(right0, left0);
      const RowPairs even1 = sum16(right1, left1), odd1 = difference16(right1, left1);
      const RowPairs even_low = low_pairs(even0, even1), even_high = high_pairs(even0, even1),
                     odd_low = low_pairs(odd0, odd1), odd_high = high_pairs(odd0, odd1);
#pragma GCC unroll 5
      for (int a = 0; a < 5; ++a) {
        const RowPairs f = factors(a, pair);
        low[a] = add_pairs(low[a], a % 2 == 0 ? even_low : odd_low, f);
        high[a] = add_pairs(high[a], a % 2 == 0 ? even_high : odd_high, f);
      }
    }
    for (int a = 0; a < 5; ++a) store_moments(low[a], high[a], moments.of[a] + r);
  }
}

/// The filter's sums of all maps of a tile. The moments i^a j^b of a map follow from those of the
/// map one row before: a row leaves, j becomes j - 1, a row comes.
inline void tile_sums(const RowMoments& rows, HeightTile& tile) {
  const int ns = tile.ns;
  const WindowWeight window_weight = window_weight_of(ns);
  ColumnSums m[5][5];
  const auto row = [&](int a, int r) {
    return load_sums(rows.of[a][r], rows.of[a][r + kSumStride]);
  };
#pragma GCC unroll 5
  for (int a = 0; a < 5; ++a) {
    for (int b = 0; a + b < 5; ++b) m[a][b] = ColumnSums{};
    for (int j = -ns; j <= ns; ++j) {
      ColumnSums part = row(a, ns + j);
#pragma GCC unroll 5
      for (int b = 0; a + b < 5; ++b) {
        m[a][b] += part;
        if (a + b < 4) part *= j;
      }
    }
  }
  for (int v = 0;; ++v) {
    const auto put = [&](int f, ColumnSums main, ColumnSums ii, ColumnSums jj) {
      store_sums(window_weight.centre * main - window_weight.fall * (ii + jj), tile.sums[v][f],
                 tile.sums[v + kSumStride][f]);
    };
    put(0, m[0][0], m[2][0], m[0][2]);
    put(1, m[1][0], m[3][0], m[1][2]);
    put(2, m[0][1], m[2][1], m[0][3]);
    put(3, m[2][0], m[4][0], m[2][2]);
    put(4, m[1][1], m[3][1], m[1][3]);
    put(5, m[0][2], m[2][2], m[0][4]);
    if (v == HeightTile::kEdge / kSumRows - 1) break;
#pragma GCC unroll 5
    for (int a = 0; a < 5; ++a) {
      ColumnSums gone = row(a, v), come = row(a, v + 2 * ns + 1);
#pragma GCC unroll 5
      for (int b = 0; a + b < 5; ++b) {
        m[a][b] -= gone;
        if (a + b < 4) gone *= -ns;
      }
      // (j - 1)^b of all b from j^b, by differences.
#pragma GCC unroll 4
      for (int pass = 1; pass < 5 - a; ++pass) {
#pragma GCC unroll 4
        for (int b = 4 - a; b >= pass; --b) m[a][b] -= m[a][b - 1];
      }
#pragma GCC unroll 5
      for (int b = 0; a + b < 5; ++b) {
        m[a][b] += come;
        if (a + b < 4) come *= ns;
      }
    }
  }
}

inline void tile_sums(const TileWords& words, HeightTile& tile) {
  RowMoments rows;
  switch ((tile.ns + 1) / 2) {
    case 1:
      row_moments<1>(words, tile.ns, rows);
      break;
    case 2:
      row_moments<2>(words, tile.ns, rows);
      break;
    case 3:
      row_moments<3>(words, tile.ns, rows);
      break;
    default:
      row_moments<4>(words, tile.ns, rows);
  }
  tile_sums(rows, tile);
}

}  // namespace

}  // namespace sulcus
