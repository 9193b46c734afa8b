// How the traces of maps follow a surface, for AVX2 and AVX-512.

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/kernels/trace_window.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

inline constexpr int kNowhere = 100;  // added to a height: beyond every window from then on

/// Step from a height to the nearest of five surface bits around it, plus kMaxStep; by pattern.
/// Four to a word, as vpermd looks words up.
struct StepTable {
  alignas(32) signed char step[32];
};
constexpr StepTable make_steps(int outward) {
  StepTable table{};
  for (int pattern = 0; pattern < 32; ++pattern) {
    table.step[pattern] = kNowhere;
    for (int step : {0, outward, -outward, 2 * outward, -2 * outward}) {
      if ((pattern >> (step + kMaxStep) & 1) != 0) {
        table.step[pattern] = static_cast<signed char>(step + kMaxStep);
        break;
      }
    }
  }
  return table;
}
inline constexpr StepTable kUpward = make_steps(1), kDownward = make_steps(-1);

#ifdef __AVX512F__
struct Steps {
  explicit Steps(const StepTable& table)
      : low(sixteen_from(table.step)), high(sixteen_from(table.step + 16)) {}
  static Sixteen sixteen_from(const signed char* step) {
    const __m128i bytes = _mm_load_si128(reinterpret_cast<const __m128i*>(step));
    return plus(_mm512_cvtepi8_epi32(bytes), -kMaxStep);
  }
  Sixteen low, high;
};
/// Lowest of the five bits that a column is looked for at, in the column next to it.
inline Sixteen follow(Sixteen surface, Sixteen at, const Steps& steps) {
  // Counts beyond 31, and negative ones, shift everything out: what is nowhere stays there.
  const __m512i five = bits_and(_mm512_srlv_epi32(surface, at), sixteen_of(31));
  return _mm512_add_epi32(at, _mm512_permutex2var_epi32(steps.low, five, steps.high));
}
#else
struct Steps {
  explicit Steps(const StepTable& of) : table(load_bits(of.step)) {}
  __m256i table;
};
inline __m256i follow(__m256i surface, __m256i at, __m256i table) {
  // Counts beyond 31, and negative ones, shift everything out: what is nowhere stays there.
  const __m256i five = _mm256_and_si256(_mm256_srlv_epi32(surface, at), _mm256_set1_epi32(31));
  const __m256i word = _mm256_permutevar8x32_epi32(table, _mm256_srli_epi32(five, 2));
  const __m256i byte = _mm256_slli_epi32(_mm256_and_si256(five, _mm256_set1_epi32(3)), 3);
  const __m256i step = _mm256_and_si256(_mm256_srlv_epi32(word, byte), _mm256_set1_epi32(0xff));
  return _mm256_add_epi32(at, _mm256_sub_epi32(step, _mm256_set1_epi32(kMaxStep)));
}
/// Lowest of the five bits that a column is looked for at, in the column next to it.
inline Sixteen follow(const Sixteen& surface, const Sixteen& at, const Steps& steps) {
  return {follow(surface.low, at.low, steps.table), follow(surface.high, at.high, steps.table)};
}
#endif

inline constexpr int kFirst =
    kLevel - kMaxStep;  // of the bits that a voxel's own column is looked for at

inline const StepTable& steps_to(int sign) { return sign > 0 ? kUpward : kDownward; }

/// Where bytes of what was followed differ, and not both are nowhere.
inline __m256i apart_in_reach(__m256i a, __m256i b) {
  const __m256i nowhere = _mm256_set1_epi8(64);  // and more; windows end below it
  return _mm256_xor_si256(_mm256_min_epi8(a, nowhere), _mm256_min_epi8(b, nowhere));
}

/// Surface bits of sixteen columns, as far as they are known.
template <int kSign>
inline Sixteen traceable(const std::uint32_t* lower, const std::uint32_t* upper, unsigned shift) {
  return bits_and(surfaces_at<kSign>(lower, upper, shift),
                  sixteen_of(static_cast<int>(kTraceable)));
}

/// Where a trace may find surfaces, or with `beyond` see them.
inline Sixteen reach_of(int trace, int beyond) {
  const int reach = trace + beyond;
  return sixteen_of(static_cast<int>(((2u << (2 * reach)) - 1u) << (kLevel - reach)));
}

/// The rings of the smallest windows that are not even because of columns at `ring` that are out of
/// line by so much; 255 where they are in line.
inline __m256i least_uneven(__m256i sum, __m256i ring) {
  const __m256i out = _mm256_abs_epi8(_mm256_max_epi8(sum, _mm256_set1_epi8(-127)));
  const auto where_over = [&](int most, __m256i rings) {
    const __m256i over = _mm256_cmpgt_epi8(out, _mm256_set1_epi8(static_cast<char>(most)));
    return _mm256_or_si256(rings, _mm256_xor_si256(over, _mm256_set1_epi8(-1)));
  };
  const __m256i of_many = _mm256_max_epu8(ring, _mm256_set1_epi8(kManyRings));
  return _mm256_min_epu8(where_over(kMostUneven, ring), where_over(kMostUnevenOfMany, of_many));
}

}  // namespace

}  // namespace sulcus
