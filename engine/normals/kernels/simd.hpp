// All vectors of the map kernels, behind plain wrappers: sixteen columns of a map's row side by
// side with AVX-512, else eight, with a scalar fallback where the plain kernels need one. Whatever
// is added up is added up in eight lanes, those of the lower half first, so that the bits do not
// depend on the set. Everything is in a file's own namespace, and nothing here includes Eigen or
// templates of the standard library but std::array: a file that is compiled for a set leaves none
// of it for others to be linked with (test KernelsKeepToThemselves).

#pragma once

#include <array>
#include <cstdint>

#include "engine/core/lanes.hpp"

namespace sulcus {

namespace {

#ifdef __AVX512F__

inline constexpr int kRowStep = 16;
using RowLanes = float __attribute__((vector_size(4 * kRowStep)));
using RowMask = __mmask16;
inline constexpr RowLanes kLaneIndex = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

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
inline RowMask bits_and(RowMask a, RowMask b) { return _kand_mask16(a, b); }
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
inline constexpr RowLanes kLaneIndex = {0, 1, 2, 3, 4, 5, 6, 7};

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
inline RowMask bits_and(const RowMask& a, const RowMask& b) { return a & b; }
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

#ifdef __AVX2__

// --- Integers, where the plain kernels have code of their own -----------------------------------

inline __m256i load_bits(const void* p) {
  return _mm256_loadu_si256(static_cast<const __m256i*>(p));
}

/// Surface bits of eight columns.
template <int kSign>
inline __m256i surface_of(const std::uint32_t* lower, const std::uint32_t* upper, __m128i down,
                          __m128i up) {
  const __m256i w = _mm256_or_si256(_mm256_srl_epi32(load_bits(lower), down),
                                    _mm256_sll_epi32(load_bits(upper), up));
  return _mm256_andnot_si256(kSign > 0 ? _mm256_srli_epi32(w, 1) : _mm256_slli_epi32(w, 1), w);
}

// Numbers of sixteen columns, a row of a narrow map.
#ifdef __AVX512F__

using Sixteen = __m512i;
inline Sixteen load_sixteen(const void* p) { return _mm512_loadu_si512(p); }
inline void store_sixteen(Sixteen v, void* p) { _mm512_storeu_si512(p, v); }
inline Sixteen sixteen_of(int v) { return _mm512_set1_epi32(v); }
inline Sixteen bits_and(Sixteen a, Sixteen b) { return _mm512_and_si512(a, b); }
inline Sixteen bits_or(Sixteen a, Sixteen b) { return _mm512_or_si512(a, b); }
inline Sixteen plus(Sixteen a, int b) { return _mm512_add_epi32(a, sixteen_of(b)); }
inline bool has_any(Sixteen v) { return _mm512_test_epi32_mask(v, v) != 0; }
/// The exponent of a power of two, which is its bit; some other number of what is none.
inline Sixteen exponents(Sixteen v) {
  return _mm512_srli_epi32(_mm512_castps_si512(_mm512_cvtepi32_ps(v)), 23);
}
template <int kSign>
inline Sixteen surfaces_at(const std::uint32_t* lower, const std::uint32_t* upper, unsigned shift) {
  const Sixteen w = _mm512_shrdv_epi32(load_sixteen(lower), load_sixteen(upper),
                                       sixteen_of(static_cast<int>(shift)));
  return _mm512_andnot_si512(kSign > 0 ? _mm512_srli_epi32(w, 1) : _mm512_slli_epi32(w, 1), w);
}
/// Every other one of twice as many.
inline Sixteen even_lanes(Sixteen a, Sixteen b) {
  return _mm512_permutex2var_epi32(
      a, _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30), b);
}
/// Of each lane but the middle one that of its neighbour toward the middle.
inline Sixteen inner_lanes(Sixteen v) {
  return _mm512_permutexvar_epi32(
      _mm512_setr_epi32(1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 9, 10, 11, 12, 13, 14), v);
}
/// As bytes, two rows; what does not fit becomes the nearest that does.
inline __m256i as_bytes(Sixteen above, Sixteen below) {
  return _mm256_set_m128i(_mm512_cvtsepi32_epi8(below), _mm512_cvtsepi32_epi8(above));
}

#else

struct Sixteen {
  __m256i low, high;
};
inline Sixteen load_sixteen(const void* p) {
  return {load_bits(p), load_bits(static_cast<const __m256i*>(p) + 1)};
}
inline void store_sixteen(const Sixteen& v, void* p) {
  _mm256_storeu_si256(static_cast<__m256i*>(p), v.low);
  _mm256_storeu_si256(static_cast<__m256i*>(p) + 1, v.high);
}
inline Sixteen sixteen_of(int v) { return {_mm256_set1_epi32(v), _mm256_set1_epi32(v)}; }
inline Sixteen bits_and(const Sixteen& a, const Sixteen& b) {
  return {_mm256_and_si256(a.low, b.low), _mm256_and_si256(a.high, b.high)};
}
inline Sixteen bits_or(const Sixteen& a, const Sixteen& b) {
  return {_mm256_or_si256(a.low, b.low), _mm256_or_si256(a.high, b.high)};
}
inline Sixteen plus(const Sixteen& a, int b) {
  const __m256i each = _mm256_set1_epi32(b);
  return {_mm256_add_epi32(a.low, each), _mm256_add_epi32(a.high, each)};
}
inline bool has_any(const Sixteen& v) {
  const __m256i all = _mm256_or_si256(v.low, v.high);
  return _mm256_testz_si256(all, all) == 0;
}
/// The exponent of a power of two, which is its bit; some other number of what is none.
inline Sixteen exponents(const Sixteen& v) {
  const auto eight = [](__m256i half) {
    return _mm256_srli_epi32(_mm256_castps_si256(_mm256_cvtepi32_ps(half)), 23);
  };
  return {eight(v.low), eight(v.high)};
}
template <int kSign>
inline Sixteen surfaces_at(const std::uint32_t* lower, const std::uint32_t* upper, unsigned shift) {
  const __m128i down = _mm_cvtsi32_si128(static_cast<int>(shift));
  const __m128i up = _mm_cvtsi32_si128(32 - static_cast<int>(shift));
  return {surface_of<kSign>(lower, upper, down, up),
          surface_of<kSign>(lower + 8, upper + 8, down, up)};
}
/// Every other one of twice as many.
inline Sixteen even_lanes(const Sixteen& a, const Sixteen& b) {
  const auto eight = [](const Sixteen& v) {
    const __m256 mixed =
        _mm256_shuffle_ps(_mm256_castsi256_ps(v.low), _mm256_castsi256_ps(v.high), 0x88);
    return _mm256_permute4x64_epi64(_mm256_castps_si256(mixed), 0xd8);
  };
  return {eight(a), eight(b)};
}
/// Of each lane but the middle one that of its neighbour toward the middle.
inline Sixteen inner_lanes(const Sixteen& v) {
  const __m256i next = _mm256_setr_epi32(1, 2, 3, 4, 5, 6, 7, 0);
  const __m256i before = _mm256_setr_epi32(0, 0, 1, 2, 3, 4, 5, 6);
  return {_mm256_permutevar8x32_epi32(_mm256_blend_epi32(v.low, v.high, 1), next),
          _mm256_permutevar8x32_epi32(v.high, before)};
}
/// As bytes, two rows; what does not fit becomes the nearest that does.
inline __m256i as_bytes(const Sixteen& above, const Sixteen& below) {
  return _mm256_permutevar8x32_epi32(_mm256_packs_epi16(_mm256_packs_epi32(above.low, above.high),
                                                        _mm256_packs_epi32(below.low, below.high)),
                                     _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
}

#endif

inline int smallest_byte(__m256i v) {
  const __m128i half = _mm_min_epu8(_mm256_castsi256_si128(v), _mm256_extracti128_si256(v, 1));
  // The words' minimum has the smallest high byte; so each word becomes the lesser of its bytes.
  const __m128i words = _mm_min_epu8(half, _mm_srli_epi16(half, 8));
  return _mm_extract_epi16(_mm_minpos_epu16(_mm_and_si128(words, _mm_set1_epi16(0xff))), 0);
}

// Bytes of a tile, eight columns of as many rows as a vector holds, in words of eight.
#ifdef __AVX512F__
using RowBytes = __m512i;
inline constexpr int kRowsAtOnce = 8;
inline RowBytes load_rows(const std::uint64_t* words) { return _mm512_loadu_si512(words); }
inline void store_rows(RowBytes bytes, void* to) { _mm512_storeu_si512(to, bytes); }
inline RowBytes plus(RowBytes a, RowBytes b) { return _mm512_add_epi8(a, b); }
inline RowBytes minus(RowBytes a, RowBytes b) { return _mm512_sub_epi8(a, b); }
inline RowBytes higher(RowBytes a, RowBytes b) { return _mm512_max_epi8(a, b); }
inline RowBytes lower(RowBytes a, RowBytes b) { return _mm512_min_epi8(a, b); }
/// From byte n of the first word of each row on, n = 0 to 7.
struct ByteShift {
  explicit ByteShift(int n) : bits(_mm512_set1_epi64(8 * n)) {}
  __m512i bits;
};
inline RowBytes from_byte(RowBytes first, RowBytes second, const ByteShift& shift) {
  return _mm512_shrdv_epi64(first, second, shift.bits);
}
/// One more where neither is over `most`: once over it they stay there, as it does not rise.
inline RowBytes count_where_even(RowBytes rings, RowBytes over, RowBytes under, int most) {
  const __mmask64 even = _mm512_cmple_epi8_mask(_mm512_max_epi8(over, under),
                                                _mm512_set1_epi8(static_cast<char>(most)));
  return _mm512_mask_add_epi8(rings, even, rings, _mm512_set1_epi8(1));
}
#else
using RowBytes = __m256i;
inline constexpr int kRowsAtOnce = 4;
inline RowBytes load_rows(const std::uint64_t* words) { return load_bits(words); }
inline void store_rows(RowBytes bytes, void* to) {
  _mm256_storeu_si256(static_cast<__m256i*>(to), bytes);
}
inline RowBytes plus(RowBytes a, RowBytes b) { return _mm256_add_epi8(a, b); }
inline RowBytes minus(RowBytes a, RowBytes b) { return _mm256_sub_epi8(a, b); }
inline RowBytes higher(RowBytes a, RowBytes b) { return _mm256_max_epi8(a, b); }
inline RowBytes lower(RowBytes a, RowBytes b) { return _mm256_min_epi8(a, b); }
struct ByteShift {
  explicit ByteShift(int n) : down(_mm_cvtsi32_si128(8 * n)), up(_mm_cvtsi32_si128(64 - 8 * n)) {}
  __m128i down, up;
};
inline RowBytes from_byte(RowBytes first, RowBytes second, const ByteShift& shift) {
  return _mm256_or_si256(_mm256_srl_epi64(first, shift.down), _mm256_sll_epi64(second, shift.up));
}
inline RowBytes count_where_even(RowBytes rings, RowBytes over, RowBytes under, int most) {
  const __m256i uneven =
      _mm256_cmpgt_epi8(_mm256_max_epi8(over, under), _mm256_set1_epi8(static_cast<char>(most)));
  return _mm256_add_epi8(rings, _mm256_andnot_si256(uneven, _mm256_set1_epi8(1)));
}
#endif

// Eight columns of two rows or four, in 16 bits, and sums of pairs of them: in each quarter, or
// half, of a vector those of one row.
#ifdef __AVX512F__
using RowPairs = __m512i;
inline constexpr int kMomentRows = 4;
/// From byte n of the first word of each row on.
inline RowPairs columns_from(const std::uint64_t* first, const std::uint64_t* second, int n) {
  return _mm512_cvtepi8_epi16(
      _mm256_shrdv_epi64(load_bits(first), load_bits(second), _mm256_set1_epi64x(8 * n)));
}
inline RowPairs sum16(RowPairs a, RowPairs b) { return _mm512_add_epi16(a, b); }
inline RowPairs difference16(RowPairs a, RowPairs b) { return _mm512_sub_epi16(a, b); }
inline RowPairs low_pairs(RowPairs a, RowPairs b) { return _mm512_unpacklo_epi16(a, b); }
inline RowPairs high_pairs(RowPairs a, RowPairs b) { return _mm512_unpackhi_epi16(a, b); }
inline RowPairs both_factors(std::int32_t two) { return _mm512_set1_epi32(two); }
inline RowPairs add_pairs(RowPairs sum, RowPairs pairs, RowPairs factors) {
  return _mm512_dpwssd_epi32(sum, pairs, factors);
}
inline void store_moments(RowPairs low, RowPairs high, std::int32_t (*to)[8]) {
  const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11),
                second = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
  _mm512_storeu_si512(to[0], _mm512_permutex2var_epi64(low, first, high));
  _mm512_storeu_si512(to[2], _mm512_permutex2var_epi64(low, second, high));
}
#else
using RowPairs = __m256i;
inline constexpr int kMomentRows = 2;
inline RowPairs columns_from(const std::uint64_t* first, const std::uint64_t* second, int n) {
  const auto words = [](const std::uint64_t* p) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
  };
  return _mm256_cvtepi8_epi16(
      _mm_or_si128(_mm_srl_epi64(words(first), _mm_cvtsi32_si128(8 * n)),
                   _mm_sll_epi64(words(second), _mm_cvtsi32_si128(64 - 8 * n))));
}
inline RowPairs sum16(RowPairs a, RowPairs b) { return _mm256_add_epi16(a, b); }
inline RowPairs difference16(RowPairs a, RowPairs b) { return _mm256_sub_epi16(a, b); }
inline RowPairs low_pairs(RowPairs a, RowPairs b) { return _mm256_unpacklo_epi16(a, b); }
inline RowPairs high_pairs(RowPairs a, RowPairs b) { return _mm256_unpackhi_epi16(a, b); }
inline RowPairs both_factors(std::int32_t two) { return _mm256_set1_epi32(two); }
inline RowPairs add_pairs(RowPairs sum, RowPairs pairs, RowPairs factors) {
  return _mm256_add_epi32(sum, _mm256_madd_epi16(pairs, factors));
}
inline void store_moments(RowPairs low, RowPairs high, std::int32_t (*to)[8]) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to[0]),
                      _mm256_permute2x128_si256(low, high, 0x20));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to[1]),
                      _mm256_permute2x128_si256(low, high, 0x31));
}
#endif

// Numbers of eight columns, of one row or of two, kSumStride rows apart.
#ifdef __AVX512F__
inline constexpr int kSumRows = 2, kSumStride = 4;
using ColumnSums = std::int32_t __attribute__((vector_size(64)));
inline ColumnSums load_sums(const std::int32_t* first, const std::int32_t* second) {
  return reinterpret_cast<ColumnSums>(
      _mm512_inserti64x4(_mm512_castsi256_si512(load_bits(first)), load_bits(second), 1));
}
inline void store_sums(const ColumnSums& v, std::int32_t* first, std::int32_t* second) {
  const auto bits = reinterpret_cast<__m512i>(v);
  _mm256_store_si256(reinterpret_cast<__m256i*>(first), _mm512_castsi512_si256(bits));
  _mm256_store_si256(reinterpret_cast<__m256i*>(second), _mm512_extracti64x4_epi64(bits, 1));
}
#else
inline constexpr int kSumRows = 1, kSumStride = 0;
using ColumnSums = IntLanes;
inline ColumnSums load_sums(const std::int32_t* row, const std::int32_t*) { return load(row); }
inline void store_sums(const ColumnSums& v, std::int32_t* row, std::int32_t*) { store(v, row); }
#endif

#endif

}  // namespace

}  // namespace sulcus
