// The filters' sums over the rows of a map, for AVX2 and AVX-512: a loop of map_kernels.hpp.

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

inline __m256i sixteen(const signed char* height) {
  return _mm256_cvtepi8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(height)));
}

inline void fit_rows(const signed char* middle, std::ptrdiff_t pitch, const QuadricFilter& filter,
                     QuadricSums& out) noexcept {
  // The filters of 1, i, i^2 and j^2 are even in j, those of j and i j odd: rows +j and -j are
  // taken together.
  const int rings = filter.rings, lanes = filter.lanes;
  __m256i sums[kQuadric] = {};
  const auto add = [&](int f, __m256i h, int place) {
    const __m256i coefficients = load_bits(&filter.coefficient[f][place]);
#ifdef __AVX512F__
    sums[f] = _mm256_dpwssd_epi32(sums[f], h, coefficients);
#else
    sums[f] = _mm256_add_epi32(sums[f], _mm256_madd_epi16(h, coefficients));
#endif
  };
  for (int chunk = 0; chunk < lanes; chunk += 16) {
    const signed char* row = middle + chunk;
    const int place = rings * lanes + chunk;
    const __m256i h0 = sixteen(row);
    for (const int f : {0, 1, 3, 5}) add(f, h0, place);
    for (int j = 1; j <= rings; ++j) {
      const __m256i above = sixteen(row + j * pitch), below = sixteen(row - j * pitch);
      const __m256i even = _mm256_add_epi16(above, below), odd = _mm256_sub_epi16(above, below);
      for (const int f : {0, 1, 3, 5}) add(f, even, place + j * lanes);
      for (const int f : {2, 4}) add(f, odd, place + j * lanes);
    }
  }
  // Four sums in the four words of one, and two in those of another.
  const auto fold = [](__m256i a, __m256i b, __m256i c, __m256i d) {
    const __m256i v = _mm256_hadd_epi32(_mm256_hadd_epi32(a, b), _mm256_hadd_epi32(c, d));
    return _mm_add_epi32(_mm256_castsi256_si128(v), _mm256_extracti128_si256(v, 1));
  };
  alignas(16) std::int32_t total[8];
  _mm_store_si128(reinterpret_cast<__m128i*>(total), fold(sums[0], sums[1], sums[2], sums[3]));
  _mm_store_si128(reinterpret_cast<__m128i*>(total + 4), fold(sums[4], sums[5], sums[4], sums[5]));
  __builtin_memcpy(&out, total, sizeof out);
}

}  // namespace

}  // namespace sulcus
