// Sums of the coarse normal, for AVX2 and AVX-512: a loop of map_kernels.hpp.

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// Sums of which each half of a vector has a part.
inline void put_sums(__m256i halves, std::array<std::int32_t, 3>& sums) {
  alignas(16) std::int32_t total[4];
  _mm_store_si128(
      reinterpret_cast<__m128i*>(total),
      _mm_add_epi32(_mm256_castsi256_si128(halves), _mm256_extracti128_si256(halves, 1)));
  __builtin_memcpy(&sums, total, sizeof sums);
}

#ifdef __AVX512F__

/// The 21 rows of five voxels as bytes, twelve rows to a vector: where a row's bits are among those
/// of all, which of them a voxel's is, and what it counts.
struct CoarseTable {
  static constexpr int kRows = 12;
  alignas(64) unsigned char from[2][64];
  alignas(64) unsigned char bit[2][64];
  alignas(64) signed char weight[3][2][64];
};
constexpr CoarseTable make_coarse_table() {
  CoarseTable table{};
  int row = 0;
  for (int k = -2; k <= 2; ++k) {
    for (int j = -2; j <= 2; ++j) {
      if (j * j + k * k > 6) continue;
      // As packed in coarse_sums: sixteens of j up to 1 and beyond, of even k and odd ones; in them
      // fours of k = -2 and -1, 0 and 1, 2.
      const int sixteen = (j == 2 ? 1 : 0) + (k == -1 || k == 1 ? 2 : 0);
      const int place = 16 * sixteen + 4 * ((k + 2) / 2) + (j == 2 ? 0 : j + 2);
      const int vector = row / CoarseTable::kRows;
      for (int i = -2; i <= 2; ++i) {
        const int lane = 5 * (row % CoarseTable::kRows) + i + 2, d2 = i * i + j * j + k * k;
        if (d2 > 6) continue;
        const int weight = kCoarseWeight.begin()[d2];
        table.from[vector][lane] = static_cast<unsigned char>(place);
        table.bit[vector][lane] = static_cast<unsigned char>(1 << (i + 2));
        table.weight[0][vector][lane] = static_cast<signed char>(i * weight);
        table.weight[1][vector][lane] = static_cast<signed char>(j * weight);
        table.weight[2][vector][lane] = static_cast<signed char>(k * weight);
      }
      ++row;
    }
  }
  return table;
}
inline constexpr CoarseTable kCoarse = make_coarse_table();

inline void coarse_sums_of(const ColumnBits::Windows& rows, std::array<std::int32_t, 3>& sums) {
  const __m512i shift = _mm512_set1_epi32(static_cast<int>(rows.shift));
  const auto patterns = [&](int k0, int k1) {  // of j = -2 to 5
    const std::uint32_t *w0 = rows.words + k0 * rows.row - 2, *w1 = rows.words + k1 * rows.row - 2;
    const auto two = [](const std::uint32_t* a, const std::uint32_t* b) {
      return _mm512_inserti64x4(_mm512_castsi256_si512(load_bits(a)), load_bits(b), 1);
    };
    const __m512i window =
        _mm512_shrdv_epi32(two(w0, w1), two(w0 + rows.plane, w1 + rows.plane), shift);
    return _mm512_and_si512(window, _mm512_set1_epi32(31));
  };
  const __m512i last = patterns(2, 2);
  const __m512i all = _mm512_packus_epi16(_mm512_packus_epi32(patterns(-2, -1), patterns(0, 1)),
                                          _mm512_packus_epi32(last, last));
  __m512i x = _mm512_setzero_si512(), y = x, z = x;
#pragma GCC unroll 2
  for (int v = 0; v < 2; ++v) {
    const __m512i row = _mm512_permutexvar_epi8(_mm512_load_si512(kCoarse.from[v]), all);
    const __m512i solid =
        _mm512_maskz_set1_epi8(_mm512_test_epi8_mask(row, _mm512_load_si512(kCoarse.bit[v])), 1);
    x = _mm512_dpbusd_epi32(x, solid, _mm512_load_si512(kCoarse.weight[0][v]));
    y = _mm512_dpbusd_epi32(y, solid, _mm512_load_si512(kCoarse.weight[1][v]));
    z = _mm512_dpbusd_epi32(z, solid, _mm512_load_si512(kCoarse.weight[2][v]));
  }
  const auto folded = [](__m512i v) {
    return _mm256_add_epi32(_mm512_castsi512_si256(v), _mm512_extracti64x4_epi64(v, 1));
  };
  const __m256i xy = _mm256_hadd_epi32(folded(x), folded(y)), zz = folded(z);
  put_sums(_mm256_hadd_epi32(xy, _mm256_hadd_epi32(zz, zz)), sums);
}

#else

/// The 21 rows of five voxels as bytes, eight to a row and four rows to a vector: where a row's
/// bits are fetched from among the bytes of three vectors (0 and 1 in the first, and so on), and
/// what its voxels count.
struct CoarseTable {
  alignas(32) signed char from[6][32];
  alignas(32) signed char weight[3][6][32];
};
constexpr CoarseTable make_coarse_table() {
  // (j, k) of the rows, as in coarse_sums below: j = -2 to 1 of k = -2 to 1, then j = 2, then k
  // = 2.
  constexpr int kNoRow = 100;
  constexpr int kRows[6][4][2] = {
      {{-1, -2}, {0, -2}, {1, -2}, {-2, -1}}, {{-1, -1}, {0, -1}, {1, -1}, {-2, 0}},
      {{-1, 0}, {0, 0}, {1, 0}, {-2, 1}},     {{-1, 1}, {0, 1}, {1, 1}, {kNoRow, 0}},
      {{2, -1}, {2, 0}, {2, 1}, {kNoRow, 0}}, {{-1, 2}, {0, 2}, {1, 2}, {kNoRow, 0}}};
  CoarseTable table{};
  for (int vector = 0; vector < 6; ++vector) {
    for (int lane = 0; lane < 32; ++lane) {
      const int j = kRows[vector][lane / 8][0], k = kRows[vector][lane / 8][1], i = lane % 8 - 2;
      table.from[vector][lane] = -1;
      if (j == kNoRow) continue;
      // Four bytes for each k, the first of them j = -2, or j = 2 in the second vector.
      const int byte = vector == 5 ? j + 2 : vector == 4 ? 4 * (k + 2) : 4 * (k + 2) + j + 2;
      table.from[vector][lane] = static_cast<signed char>(byte);
      const int d2 = i * i + j * j + k * k;
      if (i > 2 || d2 > 6) continue;
      const int weight = kCoarseWeight.begin()[d2];
      table.weight[0][vector][lane] = static_cast<signed char>(i * weight);
      table.weight[1][vector][lane] = static_cast<signed char>(j * weight);
      table.weight[2][vector][lane] = static_cast<signed char>(k * weight);
    }
  }
  return table;
}
inline constexpr CoarseTable kCoarse = make_coarse_table();

inline void coarse_sums_of(const ColumnBits::Windows& rows, std::array<std::int32_t, 3>& sums) {
  const __m128i down = _mm_cvtsi32_si128(static_cast<int>(rows.shift));
  const __m128i up = _mm_cvtsi32_si128(32 - static_cast<int>(rows.shift));
  const auto patterns = [&](int k) {  // of j = -2 to 5
    const std::uint32_t* w = rows.words + k * rows.row - 2;
    const __m256i five = _mm256_or_si256(_mm256_srl_epi32(load_bits(w), down),
                                         _mm256_sll_epi32(load_bits(w + rows.plane), up));
    return _mm256_and_si256(five, _mm256_set1_epi32(31));
  };
  const __m256i most = _mm256_packus_epi16(_mm256_packus_epi32(patterns(-2), patterns(-1)),
                                           _mm256_packus_epi32(patterns(0), patterns(1)));
  const __m256i last = patterns(2), last16 = _mm256_packus_epi32(last, last);
  const __m256i first4 = _mm256_permute4x64_epi64(most, 0x44);   // j = -2 to 1, twice
  const __m256i second4 = _mm256_permute4x64_epi64(most, 0xee);  // j = 2 and on
  const __m256i ahead = _mm256_permute4x64_epi64(_mm256_packus_epi16(last16, last16), 0x44);
  const __m256i bits = _mm256_set1_epi64x(0x1008040201), one = _mm256_set1_epi8(1);
  __m256i x = _mm256_setzero_si256(), y = x, z = x;
#pragma GCC unroll 6
  for (int v = 0; v < 6; ++v) {
    const __m256i from = v == 4 ? second4 : v == 5 ? ahead : first4;
    const __m256i row = _mm256_shuffle_epi8(from, load_bits(kCoarse.from[v]));
    const __m256i solid = _mm256_min_epu8(_mm256_and_si256(row, bits), one);
    x = _mm256_add_epi16(x, _mm256_maddubs_epi16(solid, load_bits(kCoarse.weight[0][v])));
    y = _mm256_add_epi16(y, _mm256_maddubs_epi16(solid, load_bits(kCoarse.weight[1][v])));
    z = _mm256_add_epi16(z, _mm256_maddubs_epi16(solid, load_bits(kCoarse.weight[2][v])));
  }
  const __m256i ones = _mm256_set1_epi16(1);
  const __m256i xy = _mm256_hadd_epi32(_mm256_madd_epi16(x, ones), _mm256_madd_epi16(y, ones));
  const __m256i zz = _mm256_madd_epi16(z, ones);
  const __m256i all = _mm256_hadd_epi32(xy, _mm256_hadd_epi32(zz, zz));
  put_sums(all, sums);
}

#endif

inline void coarse_sums(const ColumnBits::Windows* rows, std::size_t count,
                        std::array<std::int32_t, 3>* sums) noexcept {
  for (std::size_t k = 0; k < count; ++k) coarse_sums_of(rows[k], sums[k]);
}

}  // namespace

}  // namespace sulcus
