// Traces maps, for AVX2 and AVX-512: a loop of map_kernels.hpp.

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

inline constexpr int kRowLanes = 16;  // one row of a narrow map
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

/// |i| of each lane of two rows, and the lane of -i; the first lane has none.
inline __m256i lane_distance() {
  return _mm256_setr_epi8(8, 7, 6, 5, 4, 3, 2, 1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 7, 6, 5, 4, 3, 2, 1, 0,
                          1, 2, 3, 4, 5, 6, 7);
}
inline __m256i mirror() {
  return _mm256_setr_epi8(-1, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, -1, 15, 14, 13, 12,
                          11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1);
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

/// Reads the columns. Whether each has one surface at most within the trace; a column beyond the
/// map may have several, and is not worth a mask.
template <int kSign, int kStride>
inline bool read_columns(const ColumnBits::Windows& windows, int ns, int trace,
                         NarrowColumns& columns) {
  const Sixteen reach =
      sixteen_of(static_cast<int>(((2u << (2 * trace)) - 1u) << (kLevel - trace)));
  Sixteen several = sixteen_of(0);
  for (int r = 0; r <= 2 * ns; ++r) {
    const std::uint32_t* lower = windows.words + kStride * ((r - ns) * windows.row - kRowLanes / 2);
    const auto sixteen = [&](int k) {
      return surfaces_at<kSign>(lower + k, lower + windows.plane + k, windows.shift);
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
/// one another: then the traced map is those surfaces, and no column waits for the one before.
/// False where not.
inline bool trace_single(const NarrowColumns& columns, int trace, HeightMap& map) {
  const int ns = map.ns;
  const Sixteen reach =
      sixteen_of(static_cast<int>(((2u << (2 * trace)) - 1u) << (kLevel - trace)));
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
  // Of the middle row from lane to lane, both ways from the centre.
  const __m256i inner = _mm256_setr_epi8(1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 9, 10, 11, 12, 13, 14, 1, 2,
                                         3, 4, 5, 6, 7, 8, 8, 8, 9, 10, 11, 12, 13, 14);
  __m256i apart = beyond(_mm256_subs_epi8(before, _mm256_shuffle_epi8(before, inner)), step);
  __m256i uneven = _mm256_setzero_si256();
  signed char* out = map.height.data() + ns * kRowLanes;
  for (int j = 0;; ++j) {
    const __m256i h = before;
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

inline constexpr int kFirst =
    kLevel - kMaxStep;  // of the bits that a voxel's own column is looked for at

inline const StepTable& steps_to(int sign) { return sign > 0 ? kUpward : kDownward; }

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

/// The other rows from that one.
inline void trace_rows(const NarrowColumns& columns, const Sixteen& middle, int trace,
                       HeightMap& map) {
  const int ns = map.ns;
  const Steps steps(steps_to(map.sign));
  const int centre =
      static_cast<signed char>(_mm256_extract_epi8(as_bytes(middle, middle), kRowLanes / 2));
  NarrowRows out(map, trace, centre - kFirst);
  Sixteen above = middle, below = middle;
  for (int j = 0; j <= ns; ++j) {
    if (j > 0) {
      above = follow(columns.row(ns + j), above, steps);
      below = follow(columns.row(ns - j), below, steps);
    }
    out.take(j, _mm256_sub_epi8(as_bytes(above, below), _mm256_set1_epi8(kFirst)));
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
      trace_rows(columns[rest[n]], middle[n], trace, map[rest[n]]);
    }
  }
}

/// A map of 32 lanes, stride 1, row by row.
template <int kSign>
void trace_wide(const ColumnBits::Windows& windows, int trace, HeightMap& map) noexcept {
  constexpr int kLanes = HeightMap::kMaxLanes, kMid = kLanes / 2;
  map.lanes = kLanes;
  const int ns = map.ns;
  const StepTable& table = steps_to(kSign);
  const Steps steps(table);
  struct Row {
    Sixteen left, right;
  };
  const auto surface = [&](int j) {
    const std::uint32_t* lower = windows.words + j * windows.row - kMid;
    const std::uint32_t* upper = lower + windows.plane;
    return Row{surfaces_at<kSign>(lower, upper, windows.shift),
               surfaces_at<kSign>(lower + 16, upper + 16, windows.shift)};
  };
  const __m256i limit = _mm256_set1_epi8(static_cast<char>(trace));
  const __m256i none = _mm256_set1_epi8(HeightMap::kNone);
  alignas(32) signed char distance[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    distance[lane] = static_cast<signed char>(lane < kMid ? kMid - lane : lane - kMid);
  }
  const __m256i lane_ring = load_bits(distance);
  const __m256i outside = _mm256_cmpgt_epi8(lane_ring, _mm256_set1_epi8(static_cast<char>(ns)));
  const auto take = [&](int j, const Row& at) {
    const __m256i h = _mm256_sub_epi8(as_bytes(at.left, at.right), _mm256_set1_epi8(kFirst));
    const __m256i beyond = _mm256_or_si256(outside, _mm256_cmpgt_epi8(_mm256_abs_epi8(h), limit));
    _mm256_store_si256(reinterpret_cast<__m256i*>(map.height.data() + (ns + j) * kLanes),
                       _mm256_blendv_epi8(h, none, beyond));
  };

  alignas(64) std::uint32_t row0[kLanes];
  const Row middle_row = surface(0);
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
  Row above{load_sixteen(middle), load_sixteen(middle + 16)}, below = above;
  take(0, above);
  for (int j = 1; j <= ns; ++j) {
    const Row upper = surface(j), lower = surface(-j);
    above = {follow(upper.left, above.left, steps), follow(upper.right, above.right, steps)};
    below = {follow(lower.left, below.left, steps), follow(lower.right, below.right, steps)};
    take(j, above);
    take(-j, below);
  }

  const int centre = map.at(0, 0);
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
