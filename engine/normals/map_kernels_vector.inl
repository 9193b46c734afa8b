// The loops of map_kernels.hpp for AVX2, and for AVX-512 where a wider step pays: written once and
// compiled for each set by the files that include this.

#include <immintrin.h>

#include "engine/normals/disc_sums.inl"
#include "engine/normals/map_kernels.hpp"
#include "engine/normals/plane_step.inl"
#include "engine/normals/surface_group.inl"
#include "engine/normals/tilted_group.inl"
#include "engine/normals/tilted_points.inl"

namespace sulcus {

namespace {

constexpr int kRowLanes = 16;  // one row of a narrow map
constexpr int kNowhere = 100;  // added to a height: beyond every window from then on

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
constexpr StepTable kUpward = make_steps(1), kDownward = make_steps(-1);

/// Ring of each lane in the rows +j and -j (16 lanes each), or beyond all rings.
struct RingTable {
  alignas(32) std::uint8_t ring[8][2 * kRowLanes];
};
constexpr RingTable make_rings() {
  RingTable table{};
  for (int j = 0; j < 8; ++j) {
    for (int lane = 0; lane < 2 * kRowLanes; ++lane) {
      const int i = lane % kRowLanes - kRowLanes / 2, a = i < 0 ? -i : i;
      table.ring[j][lane] = static_cast<std::uint8_t>(a > j ? a : j);
    }
  }
  return table;
}
constexpr RingTable kRings = make_rings();

inline __m256i load_bits(const void* p) {
  return _mm256_loadu_si256(static_cast<const __m256i*>(p));
}

// --- Tracing ------------------------------------------------------------------------------------

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
inline Sixteen both(Sixteen a, Sixteen b) { return _mm512_and_si512(a, b); }
inline Sixteen either(Sixteen a, Sixteen b) { return _mm512_or_si512(a, b); }
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
  const __m512i five = both(_mm512_srlv_epi32(surface, at), sixteen_of(31));
  return _mm512_add_epi32(at, _mm512_permutex2var_epi32(steps.low, five, steps.high));
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
inline Sixteen both(const Sixteen& a, const Sixteen& b) {
  return {_mm256_and_si256(a.low, b.low), _mm256_and_si256(a.high, b.high)};
}
inline Sixteen either(const Sixteen& a, const Sixteen& b) {
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

inline int smallest_byte(__m256i v) {
  const __m128i half = _mm_min_epu8(_mm256_castsi256_si128(v), _mm256_extracti128_si256(v, 1));
  // The words' minimum has the smallest high byte; so each word becomes the lesser of its bytes.
  const __m128i words = _mm_min_epu8(half, _mm_srli_epi16(half, 8));
  return _mm_extract_epi16(_mm_minpos_epu16(_mm_and_si128(words, _mm_set1_epi16(0xff))), 0);
}

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

    const __m256i ring = load_bits(kRings.ring[j]);
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
    const Sixteen s = both(surface, reach);
    several = either(several, both(s, plus(s, -1)));
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
    return plus(exponents(both(columns.row(ns + j), reach)), -127 - kLevel);
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

constexpr int kFirst = kLevel - kMaxStep;  // of the bits that a voxel's own column is looked for at

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

template <int kSign, int kStride>
void trace_narrow(const ColumnBits::Windows& windows, int trace, HeightMap& map) noexcept {
  map.lanes = kRowLanes;
  NarrowColumns columns;
  if (read_columns<kSign, kStride>(windows, map.ns, trace, columns) &&
      trace_single(columns, trace, map)) {
    return;
  }
  trace_rows(columns, trace_middle(columns, map), trace, map);
}

/// Narrow maps of stride 1, stage by stage: in each a column waits for the one before, but not for
/// those of other maps.
inline void trace_narrow_maps(const ColumnBits::Windows* windows, std::size_t count, int trace,
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
                      ? read_columns<1, 1>(windows[first + k], map[k].ns, trace, columns[k])
                      : read_columns<-1, 1>(windows[first + k], map[k].ns, trace, columns[k]);
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

void trace_map(const ColumnBits::Windows& columns, int trace, HeightMap& map) noexcept {
  if (lanes_of(map.ns) != kRowLanes) {
    map.sign > 0 ? trace_wide<1>(columns, trace, map) : trace_wide<-1>(columns, trace, map);
  } else if (map.stride == 1) {
    map.sign > 0 ? trace_narrow<1, 1>(columns, trace, map)
                 : trace_narrow<-1, 1>(columns, trace, map);
  } else {
    map.sign > 0 ? trace_narrow<1, 2>(columns, trace, map)
                 : trace_narrow<-1, 2>(columns, trace, map);
  }
}

void trace_maps(const ColumnBits::Windows* columns, std::size_t count, int trace,
                HeightMap* maps) noexcept {
  if (lanes_of(maps[0].ns) == kRowLanes) return trace_narrow_maps(columns, count, trace, maps);
  for (std::size_t k = 0; k < count; ++k) trace_map(columns[k], trace, maps[k]);
}

}  // namespace

}  // namespace sulcus

#include "engine/normals/coarse_kernel_vector.inl"
#include "engine/normals/tile_kernels_vector.inl"

namespace sulcus {

namespace {

// --- Fits ---------------------------------------------------------------------------------------

inline __m256i sixteen(const signed char* height) {
  return _mm256_cvtepi8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(height)));
}

void fit_rows(const signed char* middle, std::ptrdiff_t pitch, const QuadricFilter& filter,
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

constexpr MapKernels vector_kernels(const char* name) {
  return {name,
          coarse_sums,
          trace_map,
          trace_maps,
          read_tile,
          cut_map,
          fit_rows,
          aim,
          look_up,
          surfaces_of,
          feet_of,
          group_residuals,
          sharpen_group,
          map_residuals,
          close_sums,
          plane_step,
          look_at_plane,
          half_sums,
          sums_on_plane,
          residuals_on_plane,
          gather_points,
          tilted_moments,
          tilted_residuals,
          sharpen_points,
          solve_quantised,
          solve_sharpened,
          tilted_feet};
}

}  // namespace

}  // namespace sulcus
