#pragma once

// Eight floats side by side, for loops that are written once and compiled for each instruction set
// by the files that include them; sixteen where a file says so first (SULCUS_LANES, which then
// needs AVX-512). The same operations in the same order give the same bits in all: sums run in
// eight lanes however many are taken at a time. Everything here is in a file's own namespace, so
// that no set's code is linked into another's.

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <cstdint>

#ifndef SULCUS_LANES
#define SULCUS_LANES 8
#endif
#if SULCUS_LANES == 16
#define SULCUS_WIDE(operation) _mm512_##operation
#else
#define SULCUS_WIDE(operation) _mm256_##operation
#endif

namespace sulcus {

namespace {

inline constexpr int kLaneCount = SULCUS_LANES;
using Lanes = float __attribute__((vector_size(4 * SULCUS_LANES)));
using IntLanes = std::int32_t __attribute__((vector_size(4 * SULCUS_LANES)));
inline constexpr int kSumLanes = 8;
using SumLanes = float __attribute__((vector_size(4 * kSumLanes)));
using DoubleLanes = double __attribute__((vector_size(8 * kSumLanes)));

inline Lanes load(const float* p) {
  Lanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline IntLanes load(const std::int32_t* p) {
  IntLanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline void store(const Lanes& v, float* p) { __builtin_memcpy(p, &v, sizeof v); }
inline void store(const IntLanes& v, std::int32_t* p) { __builtin_memcpy(p, &v, sizeof v); }

inline Lanes to_float(const IntLanes& v) { return __builtin_convertvector(v, Lanes); }
inline IntLanes to_int(const Lanes& v) { return __builtin_convertvector(v, IntLanes); }

/// v where the mask is set, else zero.
inline Lanes where(const IntLanes& mask, const Lanes& v) {
  return reinterpret_cast<Lanes>(reinterpret_cast<IntLanes>(v) & mask);
}
inline Lanes abs(const Lanes& v) { return where(IntLanes{} + 0x7fffffff, v); }
/// The larger of each lane; a's where they do not compare.
inline Lanes larger(const Lanes& a, const Lanes& b) {
#ifdef __AVX2__
  return SULCUS_WIDE(max_ps)(b, a);  // what GCC does not make of the line below
#else
  return b > a ? b : a;
#endif
}
/// The smaller of each lane; a's where they do not compare.
inline Lanes smaller(const Lanes& a, const Lanes& b) {
#ifdef __AVX2__
  return SULCUS_WIDE(min_ps)(b, a);
#else
  return b < a ? b : a;
#endif
}
inline Lanes square_root(const Lanes& v) {
#ifdef __AVX2__
  return SULCUS_WIDE(sqrt_ps)(v);
#else
  Lanes root;
  for (int lane = 0; lane < kLaneCount; ++lane) root[lane] = __builtin_sqrtf(v[lane]);
  return root;
#endif
}
/// A bit for each lane of a mask.
inline unsigned bits_of(const IntLanes& mask) {
#if SULCUS_LANES == 16
  return _mm512_movepi32_mask(reinterpret_cast<__m512i>(mask));
#elif defined(__AVX2__)
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
#else
  unsigned bits = 0;
  for (int lane = 0; lane < kLaneCount; ++lane) bits |= (mask[lane] & 1u) << lane;
  return bits;
#endif
}
inline bool any(const IntLanes& mask) { return bits_of(mask) != 0; }

#ifdef __AVX2__
/// By a mask of eight lanes: those that are in it, in order.
struct LanesOfMasks {
  alignas(8) std::uint8_t lane[256][8];
};
constexpr LanesOfMasks make_lanes_of_masks() {
  LanesOfMasks table{};
  for (int mask = 0; mask < 256; ++mask) {
    int to = 0;
    for (int lane = 0; lane < 8; ++lane) {
      if ((mask >> lane & 1) != 0) table.lane[mask][to++] = static_cast<std::uint8_t>(lane);
    }
  }
  return table;
}
inline constexpr LanesOfMasks kLanesOfMasks = make_lanes_of_masks();
/// What permutes eight lanes so that those of a mask come first, in order.
inline __m256i to_front(unsigned mask) {
  return _mm256_cvtepu8_epi32(
      _mm_loadl_epi64(reinterpret_cast<const __m128i*>(kLanesOfMasks.lane[mask])));
}
#endif

/// Adds to sums in eight lanes: of sixteen, the lower eight first.
inline void add(DoubleLanes& sum, const Lanes& v) {
#if SULCUS_LANES == 16
  const SumLanes low = __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7);
  const SumLanes high = __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15);
  sum += __builtin_convertvector(low, DoubleLanes);
  sum += __builtin_convertvector(high, DoubleLanes);
#else
  sum += __builtin_convertvector(v, DoubleLanes);
#endif
}

inline float sum_of(const SumLanes& v) {
#ifdef __AVX2__
  // What GCC makes of the line below is twice as long.
  const __m128 half = _mm_add_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
  const __m128 pair = _mm_add_ps(half, _mm_movehl_ps(half, half));
  return _mm_cvtss_f32(_mm_add_ss(pair, _mm_movehdup_ps(pair)));
#else
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
#endif
}
inline double sum_of(const DoubleLanes& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}
inline float largest_of(const SumLanes& v) {
#ifdef __AVX2__
  const __m128 half = _mm_max_ps(_mm256_extractf128_ps(v, 1), _mm256_castps256_ps128(v));
  const __m128 pair = _mm_max_ps(_mm_movehl_ps(half, half), half);
  return _mm_cvtss_f32(_mm_max_ss(_mm_movehdup_ps(pair), pair));
#else
  const auto of = [](float a, float b) { return b > a ? b : a; };
  return of(of(of(v[0], v[4]), of(v[2], v[6])), of(of(v[1], v[5]), of(v[3], v[7])));
#endif
}

}  // namespace

}  // namespace sulcus
