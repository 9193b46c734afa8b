// Traces maps of 32 lanes, for AVX2 and AVX-512: see trace_maps.hpp.

#pragma once

#include "engine/normals/kernels/follow_surface.hpp"

namespace sulcus {

namespace {

/// Surface bits of the rows of a map of 32 lanes, stride 1.
struct WideRow {
  Sixteen left, right;
};
struct WideColumns {
  static constexpr int kLanes = HeightMap::kMaxLanes, kMiddle = kLanes / 2;
  alignas(64) std::uint32_t bits[HeightMap::kMaxRows][kLanes];

  WideRow row(int r) const { return {load_sixteen(bits[r]), load_sixteen(bits[r] + 16)}; }
};

/// Which lane a byte is in, from the middle one, and those beyond a map.
inline __m256i wide_lane() {
  return _mm256_setr_epi8(-16, -15, -14, -13, -12, -11, -10, -9, -8, -7, -6, -5, -4, -3, -2, -1, 0,
                          1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
inline __m256i beyond_wide(int ns) {
  return _mm256_cmpgt_epi8(_mm256_abs_epi8(wide_lane()), _mm256_set1_epi8(static_cast<char>(ns)));
}

/// Which rings are whole and even, of heights that are stored.
inline void finish_wide(HeightMap& map) {
  constexpr int kLanes = HeightMap::kMaxLanes;
  const int ns = map.ns, centre = map.at(0, 0);
  const __m256i lane_ring = _mm256_abs_epi8(wide_lane());
  const __m256i none = _mm256_set1_epi8(HeightMap::kNone);
  const __m256i twice_centre = _mm256_set1_epi8(static_cast<char>(2 * centre));
  const __m256i backward = _mm256_setr_epi8(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0,
                                            15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
  __m256i whole = _mm256_set1_epi8(-1), even = whole;
  for (int j = -ns; j <= ns; ++j) {
    const __m256i ring =
        _mm256_max_epu8(lane_ring, _mm256_set1_epi8(static_cast<char>(j < 0 ? -j : j)));
    const __m256i h = load_bits(map.height.data() + (ns + j) * kLanes);
    const __m256i found = _mm256_xor_si256(_mm256_cmpeq_epi8(h, none), _mm256_set1_epi8(-1));
    whole = _mm256_min_epu8(whole, _mm256_or_si256(ring, found));
    // Lane of -i: from the second lane on, backward. None saturates, and is uneven.
    const __m256i other = load_bits(map.height.data() + (ns - j) * kLanes + 1);
    const __m256i opposite =
        _mm256_shuffle_epi8(_mm256_permute2x128_si256(other, other, 1), backward);
    const __m256i sum = _mm256_subs_epi8(_mm256_adds_epi8(h, opposite), twice_centre);
    even = _mm256_min_epu8(even, least_uneven(sum, ring));
  }
  const int first_gap = smallest_byte(whole) - 1, first_uneven = smallest_byte(even) - 1;
  map.whole_rings = first_gap < ns ? first_gap : ns;
  map.even_rings = first_uneven < map.whole_rings ? first_uneven : map.whole_rings;
}

/// Of each lane but the middle one that of its neighbour toward the middle.
inline WideRow inner_lanes(const WideRow& v) {
#ifdef __AVX512F__
  return {_mm512_permutex2var_epi32(
              v.left, _mm512_setr_epi32(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16),
              v.right),
          _mm512_permutexvar_epi32(
              _mm512_setr_epi32(0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14), v.right)};
#else
  const __m256i next = _mm256_setr_epi32(1, 2, 3, 4, 5, 6, 7, 0);
  const __m256i before = _mm256_setr_epi32(7, 0, 1, 2, 3, 4, 5, 6);
  const auto from = [&](__m256i a, __m256i b) {
    return _mm256_permutevar8x32_epi32(_mm256_blend_epi32(a, b, 1), next);
  };
  return {
      {from(v.left.low, v.left.high), from(v.left.high, v.right.low)},
      {_mm256_permutevar8x32_epi32(v.right.low, _mm256_setr_epi32(0, 0, 1, 2, 3, 4, 5, 6)),
       _mm256_permutevar8x32_epi32(_mm256_blend_epi32(v.right.high, v.right.low, 0x80), before)}};
#endif
}

/// Heights of a map of 32 lanes, row by row; `row_at(j)` gives their surfaces. With `kCheck` as
/// trace_rows.
template <bool kCheck, class RowAt>
inline bool trace_wide_rows(const RowAt& row_at, int trace, HeightMap& map) {
  constexpr int kLanes = WideColumns::kLanes, kMid = WideColumns::kMiddle;
  const int ns = map.ns;
  const StepTable& table = steps_to(map.sign);
  const Steps steps(table);
  const __m256i limit = _mm256_set1_epi8(static_cast<char>(trace)), outside = beyond_wide(ns);
  const __m256i none = _mm256_set1_epi8(HeightMap::kNone);
  __m256i apart = _mm256_setzero_si256();
  const auto take = [&](int j, const WideRow& at) {
    const __m256i h = _mm256_sub_epi8(as_bytes(at.left, at.right), _mm256_set1_epi8(kFirst));
    const __m256i beyond = _mm256_or_si256(outside, _mm256_cmpgt_epi8(_mm256_abs_epi8(h), limit));
    _mm256_store_si256(reinterpret_cast<__m256i*>(map.height.data() + (ns + j) * kLanes),
                       _mm256_blendv_epi8(h, none, beyond));
  };
  const auto check = [&](const WideRow& row, const WideRow& at) {
    const WideRow inner = inner_lanes(at);
    const __m256i beside =
        as_bytes(follow(row.left, inner.left, steps), follow(row.right, inner.right, steps));
    apart = _mm256_or_si256(apart, apart_in_reach(as_bytes(at.left, at.right), beside));
  };
  alignas(64) std::uint32_t row0[kLanes];
  const WideRow middle_row = row_at(0);
  store_sixteen(middle_row.left, row0);
  store_sixteen(middle_row.right, row0 + 16);
  alignas(64) int middle[kLanes];
  for (int& at : middle) at = kNowhere;
  const auto follow_one = [&](std::uint32_t bits, int at) {
    const std::uint32_t five = at >= 0 && at < 32 ? bits >> at & 31u : 0u;
    return at + table.step[five] - kMaxStep;
  };
  int left = middle[kMid] = follow_one(row0[kMid], kFirst), right = left;
  for (int i = 1; i <= ns; ++i) {
    middle[kMid + i] = right = follow_one(row0[kMid + i], right);
    middle[kMid - i] = left = follow_one(row0[kMid - i], left);
  }
  WideRow above{load_sixteen(middle), load_sixteen(middle + 16)}, below = above;
  take(0, above);
  for (int j = 1; j <= ns; ++j) {
    const WideRow upper = row_at(j), lower = row_at(-j);
    above = {follow(upper.left, above.left, steps), follow(upper.right, above.right, steps)};
    below = {follow(lower.left, below.left, steps), follow(lower.right, below.right, steps)};
    take(j, above);
    take(-j, below);
    if constexpr (kCheck) {
      check(upper, above);
      check(lower, below);
    }
  }
  return _mm256_testc_si256(outside, apart) != 0;
}

/// The same map along its columns first, or in both orders, from the one along its rows: what these
/// find alike.
template <class RowAt>
inline void trace_wide_columns(const RowAt& row_at, int trace, HeightMap& map) {
  constexpr int kMid = WideColumns::kMiddle;
  const int ns = map.ns;
  WideColumns turned{};
  for (int j = -ns; j <= ns; ++j) {
    alignas(64) std::uint32_t bits[WideColumns::kLanes];
    const WideRow row = row_at(j);
    store_sixteen(row.left, bits);
    store_sixteen(row.right, bits + 16);
    for (int i = -ns; i <= ns; ++i) turned.bits[ns + i][kMid + j] = bits[kMid + i];
  }
  HeightMap other = map;
  trace_wide_rows<false>([&](int j) { return turned.row(ns + j); }, trace, other);
  for (int j = -ns; j <= ns; ++j) {
    for (int i = -ns; i <= ns; ++i) {
      const signed char height = other.height.data()[map.place(j, i)];
      signed char& to = map.height.data()[map.place(i, j)];
      to = map.order == TraceOrder::kColumnFirst || to == height ? height : HeightMap::kNone;
    }
  }
}

template <int kSign>
void trace_wide(const ColumnBits::Windows& windows, int trace, HeightMap& map) noexcept {
  map.lanes = WideColumns::kLanes;
  const auto row_at = [&](int j) {
    const std::uint32_t* lower = windows.words + j * windows.row - WideColumns::kMiddle;
    const std::uint32_t* upper = lower + windows.plane;
    return WideRow{traceable<kSign>(lower, upper, windows.shift),
                   traceable<kSign>(lower + 16, upper + 16, windows.shift)};
  };
  if (map.order == TraceOrder::kRowFirst) {
    trace_wide_rows<false>(row_at, trace, map);
  } else if (!trace_wide_rows<true>(row_at, trace, map)) {
    trace_wide_columns(row_at, trace, map);
  }
  finish_wide(map);
}

}  // namespace

}  // namespace sulcus
