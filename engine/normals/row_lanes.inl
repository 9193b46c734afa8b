// Columns of a map's row side by side: sixteen with AVX-512, else eight. Whatever is added up is
// added up in eight lanes, those of the lower half first, so that the bits do not depend on the
// set.

#pragma once

#include <array>

#include "engine/core/lanes.hpp"

namespace sulcus {

namespace {

#ifdef __AVX512F__

inline constexpr int kRowStep = 16;
using RowLanes = float __attribute__((vector_size(4 * kRowStep)));
using RowMask = __mmask16;
constexpr RowLanes kAlong = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

inline __m128i bytes_of(const signed char* row) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(row));
}
inline RowLanes widened(__m128i bytes) { return _mm512_cvtepi32_ps(_mm512_cvtepi8_epi32(bytes)); }
/// Heights of a row as they lie.
inline RowLanes heights(const signed char* row) { return widened(bytes_of(row)); }
/// Less that of the voxel. Of what is none, any number.
inline RowLanes heights_above(const signed char* row, int level) {
  return widened(_mm_sub_epi8(bytes_of(row), _mm_set1_epi8(static_cast<char>(level))));
}
inline RowLanes abs(const RowLanes& v) { return _mm512_abs_ps(v); }
inline RowLanes larger(const RowLanes& a, const RowLanes& b) { return _mm512_max_ps(b, a); }
/// v where the mask is set, else zero.
inline RowLanes where(RowMask mask, const RowLanes& v) { return _mm512_maskz_mov_ps(mask, v); }
inline RowMask at_most(const RowLanes& v, float limit) {
  return _mm512_cmp_ps_mask(v, RowLanes{} + limit, _CMP_LE_OQ);
}
inline RowMask above(const RowLanes& v, float limit) {
  return _mm512_cmp_ps_mask(v, RowLanes{} + limit, _CMP_GT_OQ);
}
inline RowMask both(RowMask a, RowMask b) { return _kand_mask16(a, b); }
inline int count_of(RowMask mask) { return __builtin_popcount(mask); }
inline Lanes lower_half(const RowLanes& v) { return _mm512_castps512_ps256(v); }
inline Lanes upper_half(const RowLanes& v) { return _mm512_extractf32x8_ps(v, 1); }
inline void add_row(Lanes& sum, const RowLanes& v) {
  sum += lower_half(v);
  sum += upper_half(v);
}
/// What `add_row` adds to nothing.
inline Lanes halves_of(const RowLanes& v) { return lower_half(v) + upper_half(v); }
inline void take_larger(Lanes& largest, const RowLanes& v) {
  largest = larger(largest, larger(lower_half(v), upper_half(v)));
}
inline float largest_of(const RowLanes& v) {
  return largest_of(larger(lower_half(v), upper_half(v)));
}

#else

inline constexpr int kRowStep = 8;
using RowLanes = Lanes;
using RowMask = IntLanes;
constexpr RowLanes kAlong = {0, 1, 2, 3, 4, 5, 6, 7};

/// Heights of a row as they lie.
inline RowLanes heights(const signed char* row) {
#ifdef __AVX2__
  const __m128i eight = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(row));
  return to_float(reinterpret_cast<IntLanes>(_mm256_cvtepi8_epi32(eight)));
#else
  return to_float(IntLanes{row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7]});
#endif
}
/// Less that of the voxel. Of what is none, any number.
inline RowLanes heights_above(const signed char* row, int level) {
  return heights(row) - static_cast<float>(level);
}
inline RowMask at_most(const RowLanes& v, float limit) { return v <= limit; }
inline RowMask above(const RowLanes& v, float limit) { return v > limit; }
inline RowMask both(const RowMask& a, const RowMask& b) { return a & b; }
inline int count_of(const RowMask& mask) { return __builtin_popcount(bits_of(mask)); }
inline void add_row(Lanes& sum, const RowLanes& v) { sum += v; }
inline Lanes halves_of(const RowLanes& v) { return v; }
inline void take_larger(Lanes& largest, const RowLanes& v) { largest = larger(largest, v); }

#endif

/// Of eight vectors what `sum_of`, or `largest_of`, makes of each.
#ifdef __AVX2__
template <class Join>
inline Lanes fold_each(const Lanes (&v)[8], const Join& join) {
  // Halves of each vector, of two at a time, then the halves of those, and so on: always first
  // with third, then second.
  __m256 four[4], two[2];
  for (int k = 0; k < 4; ++k) {
    four[k] = join(_mm256_permute2f128_ps(v[k], v[k + 4], 0x20),
                   _mm256_permute2f128_ps(v[k], v[k + 4], 0x31));
  }
  for (int k = 0; k < 2; ++k) {
    two[k] = join(_mm256_shuffle_ps(four[k], four[k + 2], 0x44),
                  _mm256_shuffle_ps(four[k], four[k + 2], 0xee));
  }
  // Of vectors 0, 2 and, in the upper half, 4, 6; and of the odd ones.
  const __m256 even = _mm256_shuffle_ps(two[0], two[1], 0x88),
               odd = _mm256_shuffle_ps(two[0], two[1], 0xdd);
  return _mm256_permute_ps(join(even, odd), 0xd8);
}
inline Lanes sum_each(const Lanes (&v)[8]) {
  return fold_each(v, [](__m256 a, __m256 b) { return _mm256_add_ps(a, b); });
}
inline Lanes largest_each(const Lanes (&v)[8]) {
  return fold_each(v, [](__m256 a, __m256 b) { return _mm256_max_ps(a, b); });
}
#else
inline Lanes sum_each(const Lanes (&v)[8]) {
  Lanes each;
  for (int k = 0; k < 8; ++k) each[k] = sum_of(v[k]);
  return each;
}
inline Lanes largest_each(const Lanes (&v)[8]) {
  Lanes each;
  for (int k = 0; k < 8; ++k) each[k] = largest_of(v[k]);
  return each;
}
#endif

/// Of each what `sum_of` makes of it.
template <std::size_t kSums>
inline std::array<float, kSums> sum_all(const std::array<Lanes, kSums>& v) {
  std::array<float, (kSums + 7) / 8 * 8> sums;
  for (std::size_t f = 0; f < kSums; f += 8) {
    Lanes eight[8];
    for (std::size_t k = 0; k < 8; ++k) eight[k] = f + k < kSums ? v.begin()[f + k] : Lanes{};
    store(sum_each(eight), sums.begin() + f);
  }
  std::array<float, kSums> all;
  __builtin_memcpy(&all, &sums, sizeof all);
  return all;
}

inline RowLanes load_row(const float* p) {
  RowLanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline void store_row(const RowLanes& v, float* p) { __builtin_memcpy(p, &v, sizeof v); }

}  // namespace

}  // namespace sulcus
