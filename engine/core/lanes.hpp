#pragma once

// Eight floats side by side, for loops that are written once and compiled for each instruction set
// by the files that include them. The same operations in the same order give the same bits in all.
// Everything here is in a file's own namespace, so that no set's code is linked into another's.

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <cstdint>

namespace sulcus {

namespace {

using Lanes = float __attribute__((vector_size(32)));
using IntLanes = std::int32_t __attribute__((vector_size(32)));
using DoubleLanes = double __attribute__((vector_size(64)));
inline constexpr int kLaneCount = 8;

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
inline Lanes abs(const Lanes& v) {
  constexpr IntLanes kSize = {0x7fffffff, 0x7fffffff, 0x7fffffff, 0x7fffffff,
                              0x7fffffff, 0x7fffffff, 0x7fffffff, 0x7fffffff};
  return where(kSize, v);
}
/// The larger of each lane; a's where they do not compare.
inline Lanes larger(const Lanes& a, const Lanes& b) {
#ifdef __AVX2__
  return _mm256_max_ps(b, a);  // what GCC does not make of the line below
#else
  return b > a ? b : a;
#endif
}
/// The smaller of each lane; a's where they do not compare.
inline Lanes smaller(const Lanes& a, const Lanes& b) {
#ifdef __AVX2__
  return _mm256_min_ps(b, a);
#else
  return b < a ? b : a;
#endif
}
inline Lanes square_root(const Lanes& v) {
#ifdef __AVX2__
  return _mm256_sqrt_ps(v);
#else
  Lanes root;
  for (int lane = 0; lane < kLaneCount; ++lane) root[lane] = __builtin_sqrtf(v[lane]);
  return root;
#endif
}
inline bool any(const IntLanes& mask) {
#ifdef __AVX2__
  return _mm256_testz_si256(reinterpret_cast<__m256i>(mask), reinterpret_cast<__m256i>(mask)) == 0;
#else
  std::int32_t all = 0;
  for (int lane = 0; lane < kLaneCount; ++lane) all |= mask[lane];
  return all != 0;
#endif
}

inline float sum_of(const Lanes& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}
inline double sum_of(const DoubleLanes& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}
inline float largest_of(const Lanes& v) {
  float largest = v[0];
  for (int lane = 1; lane < kLaneCount; ++lane) largest = v[lane] > largest ? v[lane] : largest;
  return largest;
}

}  // namespace

}  // namespace sulcus
