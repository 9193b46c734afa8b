// Traces maps, for AVX2 and AVX-512: a loop of map_kernels.hpp.

#pragma once

#include "engine/normals/kernels/trace_wide_maps.hpp"

namespace sulcus {

namespace {

inline constexpr int kRowLanes = 16;  // one row of a narrow map

/// |i| of each lane of two rows, and the lane of -i; the first lane has none.
inline __m256i lane_distance() {
  return _mm256_setr_epi8(8, 7, 6, 5, 4, 3, 2, 1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 7, 6, 5, 4, 3, 2, 1, 0,
                          1, 2, 3, 4, 5, 6, 7);
}
inline __m256i mirror() {
  return _mm256_setr_epi8(-1, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, -1, 15, 14, 13, 12,
                          11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1);
}

/// A map as it is packed, checked and stored: rows +j and -j at a time.
class NarrowRows {
 public:
  NarrowRows(HeightMap& map, int trace, int centre)
      : map_(map),
        outside_(_mm256_cmpgt_epi8(lane_distance(), _mm256_set1_epi8(static_cast<char>(map.ns)))),
        limit_(_mm256_set1_epi8(static_cast<char>(trace))),
        twice_centre_(_mm256_set1_epi8(static_cast<char>(2 * centre))) {}

  /// `h`: heights of row +j in the lower half, of -j in the upper.
  void take(int j, __m256i h) {
    const __m256i beyond = _mm256_or_si256(outside_, _mm256_cmpgt_epi8(_mm256_abs_epi8(h), limit_));
    h = _mm256_blendv_epi8(h, _mm256_set1_epi8(HeightMap::kNone), beyond);
    signed char* height = map_.height.data() + map_.ns * kRowLanes;
    _mm_store_si128(reinterpret_cast<__m128i*>(height + j * kRowLanes), _mm256_castsi256_si128(h));
    _mm_store_si128(reinterpret_cast<__m128i*>(height - j * kRowLanes),
                    _mm256_extracti128_si256(h, 1));

    const __m256i ring = _mm256_max_epu8(lane_distance(), _mm256_set1_epi8(static_cast<char>(j)));
    const __m256i good = _mm256_xor_si256(beyond, _mm256_set1_epi8(-1));
    whole_ = _mm256_min_epu8(whole_, _mm256_or_si256(ring, good));
    // None saturates with whatever it meets, and is uneven.
    const __m256i opposite = _mm256_shuffle_epi8(_mm256_permute2x128_si256(h, h, 1), mirror());
    const __m256i sum = _mm256_subs_epi8(_mm256_adds_epi8(h, opposite), twice_centre_);
    even_ = _mm256_min_epu8(even_, least_uneven(sum, ring));
  }

  void finish() {
    const int first_gap = smallest_byte(whole_) - 1, first_uneven = smallest_byte(even_) - 1;
    map_.whole_rings = first_gap < map_.ns ? first_gap : map_.ns;
    map_.even_rings = first_uneven < map_.whole_rings ? first_uneven : map_.whole_rings;
  }

 private:
  HeightMap& map_;
  __m256i outside_, limit_, twice_centre_;
  __m256i whole_ = _mm256_set1_epi8(-1), even_ = whole_;  // least bad ring of each lane
};

/// The rings of a map whose heights are all found and stored; which are uneven matters only where
/// any within the map is.
inline void finish_whole(__m256i uneven, __m256i outside, int trace, int centre, HeightMap& map) {
  map.whole_rings = map.even_rings = map.ns;
  if (_mm256_testc_si256(outside, uneven) != 0) return;
  const signed char* middle = &map.height.front() + map.ns * kRowLanes;
  NarrowRows rows(map, trace, centre);
  for (int j = 0; j <= map.ns; ++j) {
    const auto* above = reinterpret_cast<const __m128i*>(middle + j * kRowLanes);
    const auto* below = reinterpret_cast<const __m128i*>(middle - j * kRowLanes);
    rows.take(j, _mm256_set_m128i(_mm_load_si128(below), _mm_load_si128(above)));
  }
  rows.finish();
}

/// Surface bits of a map's rows.
struct NarrowColumns {
  alignas(64) std::uint32_t bits[2 * 7 + 1][kRowLanes];

  Sixteen row(int r) const { return load_sixteen(bits[r]); }
};

/// Reads the columns. Whether each has one surface at most as far as a step from the trace leads; a
/// column beyond the map may have several, and is not worth a mask.
template <int kSign, int kStride>
inline bool read_columns(const ColumnBits::Windows& windows, int ns, int trace,
                         NarrowColumns& columns) {
  const Sixteen reach = reach_of(trace, kMaxStep);
  Sixteen several = sixteen_of(0);
  for (int r = 0; r <= 2 * ns; ++r) {
    const std::uint32_t* lower = windows.words + kStride * ((r - ns) * windows.row - kRowLanes / 2);
    const auto sixteen = [&](int k) {
      return traceable<kSign>(lower + k, lower + windows.plane + k, windows.shift);
    };
    Sixteen surface;
    if constexpr (kStride == 1) {
      surface = sixteen(0);
    } else {
      surface = even_lanes(sixteen(0), sixteen(16));
    }
    store_sixteen(surface, columns.bits[r]);
    const Sixteen s = bits_and(surface, reach);
    several = bits_or(several, bits_and(s, plus(s, -1)));
  }
  return !has_any(several);
}

/// Finds a map at once where every column has one surface within the trace and all are in reach of
/// their neighbours: then the traced map is those surfaces, in whatever order, and no column waits
/// for the one before. False where not.
inline bool trace_single(const NarrowColumns& columns, int trace, HeightMap& map) {
  const int ns = map.ns;
  const Sixteen reach = reach_of(trace, 0);
  const auto height = [&](int j) {
    return plus(exponents(bits_and(columns.row(ns + j), reach)), -127 - kLevel);
  };
  const Sixteen middle = height(0);
  __m256i before = as_bytes(middle, middle);
  const int centre = static_cast<signed char>(_mm256_extract_epi8(before, kRowLanes / 2));
  const __m256i twice_centre = _mm256_set1_epi8(static_cast<char>(2 * centre));
  const __m256i outside =
      _mm256_cmpgt_epi8(lane_distance(), _mm256_set1_epi8(static_cast<char>(ns)));
  const __m256i step = _mm256_set1_epi8(kMaxStep), most = _mm256_set1_epi8(kMostUnevenOfMany);
  const __m256i none = _mm256_set1_epi8(HeightMap::kNone);
  const auto beyond = [](__m256i a, __m256i limit) {
    return _mm256_subs_epu8(_mm256_abs_epi8(a), limit);
  };
  // Of the rows from lane to lane, both ways from the centre.
  const __m256i inner = _mm256_setr_epi8(1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 9, 10, 11, 12, 13, 14, 1, 2,
                                         3, 4, 5, 6, 7, 8, 8, 8, 9, 10, 11, 12, 13, 14);
  __m256i apart = _mm256_setzero_si256(), uneven = apart;
  signed char* out = map.height.data() + ns * kRowLanes;
  for (int j = 0;; ++j) {
    const __m256i h = before;
    apart =
        _mm256_or_si256(apart, beyond(_mm256_subs_epi8(h, _mm256_shuffle_epi8(h, inner)), step));
    const __m256i opposite = _mm256_shuffle_epi8(_mm256_permute2x128_si256(h, h, 1), mirror());
    uneven = _mm256_or_si256(
        uneven, beyond(_mm256_subs_epi8(_mm256_adds_epi8(h, opposite), twice_centre), most));
    const __m256i stored = _mm256_blendv_epi8(h, none, outside);
    _mm_store_si128(reinterpret_cast<__m128i*>(out + j * kRowLanes),
                    _mm256_castsi256_si128(stored));
    _mm_store_si128(reinterpret_cast<__m128i*>(out - j * kRowLanes),
                    _mm256_extracti128_si256(stored, 1));
    if (j == ns) break;
    before = as_bytes(height(j + 1), height(-j - 1));
    apart = _mm256_or_si256(apart, beyond(_mm256_subs_epi8(before, h), step));
  }
  if (centre < -kMaxStep || centre > kMaxStep || _mm256_testc_si256(outside, apart) == 0) {
    return false;
  }
  finish_whole(uneven, outside, trace, centre, map);
  return true;
}

/// The middle row, traced, as the lowest bits that the next columns are looked for at. From lane to
/// lane outward: after n steps those of n columns to either side are right, and a column followed
/// from its own height stays there.
inline Sixteen trace_middle(const NarrowColumns& columns, const HeightMap& map) {
  const Steps steps(steps_to(map.sign));
  const Sixteen row = columns.row(map.ns);
  Sixteen middle = follow(row, sixteen_of(kFirst), steps);
  for (int i = 1; i <= map.ns; ++i) middle = follow(row, inner_lanes(middle), steps);
  return middle;
}

/// The other rows from that one. With `kCheck` whether the columns first would find the same: where
/// each column, followed from its inner neighbour in its row, stays at its height.
template <bool kCheck>
inline bool trace_rows(const NarrowColumns& columns, const Sixteen& middle, int trace,
                       HeightMap& map) {
  const int ns = map.ns;
  const Steps steps(steps_to(map.sign));
  const int centre =
      static_cast<signed char>(_mm256_extract_epi8(as_bytes(middle, middle), kRowLanes / 2));
  NarrowRows out(map, trace, centre - kFirst);
  Sixteen above = middle, below = middle;
  __m256i apart = _mm256_setzero_si256();
  for (int j = 0; j <= ns; ++j) {
    if (j > 0) {
      const Sixteen upper = columns.row(ns + j), lower = columns.row(ns - j);
      above = follow(upper, above, steps);
      below = follow(lower, below, steps);
      if constexpr (kCheck) {
        const __m256i beside = as_bytes(follow(upper, inner_lanes(above), steps),
                                        follow(lower, inner_lanes(below), steps));
        apart = _mm256_or_si256(apart, apart_in_reach(as_bytes(above, below), beside));
      }
    }
    out.take(j, _mm256_sub_epi8(as_bytes(above, below), _mm256_set1_epi8(kFirst)));
  }
  out.finish();
  const __m256i outside =
      _mm256_cmpgt_epi8(lane_distance(), _mm256_set1_epi8(static_cast<char>(ns)));
  return _mm256_testc_si256(outside, apart) != 0;
}

/// Traces along the middle column first, or in both orders: what these find alike. Every row from
/// lane to lane outward, as the middle one in trace_middle.
inline void trace_columns(const NarrowColumns& columns, int trace, HeightMap& map) {
  const int ns = map.ns;
  const Steps steps(steps_to(map.sign));
  Sixteen at[2 * 7 + 1];
  at[ns] = follow(columns.row(ns), sixteen_of(kFirst), steps);
  for (int j = 1; j <= ns; ++j) {
    at[ns + j] = follow(columns.row(ns + j), at[ns + j - 1], steps);
    at[ns - j] = follow(columns.row(ns - j), at[ns - j + 1], steps);
  }
  for (int i = 1; i <= ns; ++i) {
    for (int r = 0; r <= 2 * ns; ++r) at[r] = follow(columns.row(r), inner_lanes(at[r]), steps);
  }
  const int centre =
      static_cast<signed char>(_mm256_extract_epi8(as_bytes(at[ns], at[ns]), kRowLanes / 2));
  NarrowRows out(map, trace, centre - kFirst);
  const bool both = map.order == TraceOrder::kBoth;
  Sixteen above = both ? trace_middle(columns, map) : at[ns], below = above;
  for (int j = 0; j <= ns; ++j) {
    __m256i h = as_bytes(at[ns + j], at[ns - j]);
    if (both) {
      if (j > 0) {
        above = follow(columns.row(ns + j), above, steps);
        below = follow(columns.row(ns - j), below, steps);
      }
      const __m256i alike = _mm256_cmpeq_epi8(h, as_bytes(above, below));
      h = _mm256_blendv_epi8(_mm256_set1_epi8(kNowhere), h, alike);
    }
    out.take(j, _mm256_sub_epi8(h, _mm256_set1_epi8(kFirst)));
  }
  out.finish();
}

/// Narrow maps, stage by stage: in each a column waits for the one before, but not for those of
/// other maps.
template <int kStride>
inline void trace_narrow(const ColumnBits::Windows* windows, std::size_t count, int trace,
                         HeightMap* maps) {
  constexpr std::size_t kTogether = 8;
  for (std::size_t first = 0; first < count; first += kTogether) {
    const std::size_t end = count - first < kTogether ? count - first : kTogether;
    HeightMap* const map = maps + first;
    NarrowColumns columns[kTogether];
    bool single[kTogether];
    for (std::size_t k = 0; k < end; ++k) {
      map[k].lanes = kRowLanes;
      single[k] = map[k].sign > 0
                      ? read_columns<1, kStride>(windows[first + k], map[k].ns, trace, columns[k])
                      : read_columns<-1, kStride>(windows[first + k], map[k].ns, trace, columns[k]);
    }
    std::size_t rest[kTogether], to_follow = 0;
    for (std::size_t k = 0; k < end; ++k) {
      if (!single[k] || !trace_single(columns[k], trace, map[k])) rest[to_follow++] = k;
    }
    Sixteen middle[kTogether];
    for (std::size_t n = 0; n < to_follow; ++n) {
      middle[n] = trace_middle(columns[rest[n]], map[rest[n]]);
    }
    for (std::size_t n = 0; n < to_follow; ++n) {
      const std::size_t k = rest[n];
      if (map[k].order == TraceOrder::kRowFirst) {
        trace_rows<false>(columns[k], middle[n], trace, map[k]);
      } else if (!trace_rows<true>(columns[k], middle[n], trace, map[k])) {
        trace_columns(columns[k], trace, map[k]);
      }
    }
  }
}

inline void trace_maps(const ColumnBits::Windows* columns, std::size_t count, int trace,
                       HeightMap* maps) noexcept {
  if (lanes_of(maps[0].ns) == kRowLanes) {
    return maps[0].stride == 1 ? trace_narrow<1>(columns, count, trace, maps)
                               : trace_narrow<2>(columns, count, trace, maps);
  }
  for (std::size_t k = 0; k < count; ++k) {
    maps[k].sign > 0 ? trace_wide<1>(columns[k], trace, maps[k])
                     : trace_wide<-1>(columns[k], trace, maps[k]);
  }
}

}  // namespace

}  // namespace sulcus
