// Compiled for AVX2. Leaves no inline code for others to be linked with (test
// KernelsKeepToThemselves).
#include "engine/normals/map_kernels.hpp"

#ifdef __AVX2__

#include <immintrin.h>

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

/// Every other one of sixteen.
inline __m256i even_lanes(__m256i a, __m256i b) {
  const __m256 mixed = _mm256_shuffle_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b), 0x88);
  return _mm256_permute4x64_epi64(_mm256_castps_si256(mixed), 0xd8);
}

/// Lowest of the five bits that a column is looked for at, in the column next to it.
inline __m256i follow(__m256i surface, __m256i at, __m256i table) {
  // Counts beyond 31, and negative ones, shift everything out: what is nowhere stays there.
  const __m256i five = _mm256_and_si256(_mm256_srlv_epi32(surface, at), _mm256_set1_epi32(31));
  const __m256i word = _mm256_permutevar8x32_epi32(table, _mm256_srli_epi32(five, 2));
  const __m256i byte = _mm256_slli_epi32(_mm256_and_si256(five, _mm256_set1_epi32(3)), 3);
  const __m256i step = _mm256_and_si256(_mm256_srlv_epi32(word, byte), _mm256_set1_epi32(0xff));
  return _mm256_add_epi32(at, _mm256_sub_epi32(step, _mm256_set1_epi32(kMaxStep)));
}

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
    const __m256i uneven =
        _mm256_cmpgt_epi8(_mm256_abs_epi8(_mm256_max_epi8(sum, _mm256_set1_epi8(-127))),
                          _mm256_set1_epi8(kMaxUneven));
    even_ = _mm256_min_epu8(even_,
                            _mm256_or_si256(ring, _mm256_xor_si256(uneven, _mm256_set1_epi8(-1))));
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

/// Heights of sixteen columns in rows +j and -j as bytes.
inline __m256i as_bytes(__m256i above0, __m256i above1, __m256i below0, __m256i below1) {
  return _mm256_permutevar8x32_epi32(
      _mm256_packs_epi16(_mm256_packs_epi32(above0, above1), _mm256_packs_epi32(below0, below1)),
      _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
}

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
  alignas(32) std::uint32_t bits[2 * 7 + 1][kRowLanes];
};

/// Reads the columns, and finds the map at once where every column has one surface within the
/// trace and all are in reach of one another: then the traced map is those surfaces, and no column
/// waits for the one before. False where not; the columns are read all the same.
template <int kSign, int kStride>
inline bool trace_single(const ColumnBits::Windows& windows, int trace, HeightMap& map,
                         NarrowColumns& columns) {
  const int ns = map.ns;
  const __m128i down = _mm_cvtsi32_si128(static_cast<int>(windows.shift));
  const __m128i up = _mm_cvtsi32_si128(32 - static_cast<int>(windows.shift));
  const __m256i reach =
      _mm256_set1_epi32(static_cast<int>(((2u << (2 * trace)) - 1u) << (kLevel - trace)));
  const __m256i minus_one = _mm256_set1_epi32(-1);
  // The exponent of a power of two is its bit.
  const __m256i zero_height = _mm256_set1_epi32(127 + kLevel);
  __m256i several = _mm256_setzero_si256();
  const auto height = [&](__m256i surface) {
    const __m256i s = _mm256_and_si256(surface, reach);
    several = _mm256_or_si256(several, _mm256_and_si256(s, _mm256_add_epi32(s, minus_one)));
    const __m256i exponent = _mm256_srli_epi32(_mm256_castps_si256(_mm256_cvtepi32_ps(s)), 23);
    return _mm256_sub_epi32(exponent, zero_height);
  };
  struct Row {
    __m256i low, high;
  };
  const auto row = [&](int j) {
    const std::uint32_t* lower = windows.words + kStride * (j * windows.row - kRowLanes / 2);
    const std::uint32_t* upper = lower + windows.plane;
    const auto eight = [&](int k) {
      return surface_of<kSign>(lower + 8 * k, upper + 8 * k, down, up);
    };
    Row surface;
    if constexpr (kStride == 1) {
      surface = {eight(0), eight(1)};
    } else {
      surface = {even_lanes(eight(0), eight(1)), even_lanes(eight(2), eight(3))};
    }
    auto* bits = reinterpret_cast<__m256i*>(columns.bits[ns + j]);
    _mm256_store_si256(bits, surface.low);
    _mm256_store_si256(bits + 1, surface.high);
    return Row{height(surface.low), height(surface.high)};
  };

  const Row middle = row(0);
  __m256i before = as_bytes(middle.low, middle.high, middle.low, middle.high);
  const int centre = static_cast<signed char>(_mm256_extract_epi8(before, kRowLanes / 2));
  const __m256i twice_centre = _mm256_set1_epi8(static_cast<char>(2 * centre));
  const __m256i outside =
      _mm256_cmpgt_epi8(lane_distance(), _mm256_set1_epi8(static_cast<char>(ns)));
  const __m256i step = _mm256_set1_epi8(kMaxStep), most = _mm256_set1_epi8(kMaxUneven);
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
    const Row above = row(j + 1), below = row(-j - 1);
    before = as_bytes(above.low, above.high, below.low, below.high);
    apart = _mm256_or_si256(apart, beyond(_mm256_subs_epi8(before, h), step));
  }
  // A column beyond the map may hold several: not worth a mask.
  if (centre < -kMaxStep || centre > kMaxStep || _mm256_testc_si256(outside, apart) == 0 ||
      _mm256_testz_si256(several, several) == 0) {
    return false;
  }
  finish_whole(uneven, outside, trace, centre, map);
  return true;
}

template <int kSign>
void trace_columns(const NarrowColumns& columns, int trace, HeightMap& map) noexcept {
  constexpr int kMid = kRowLanes / 2, kFirst = kLevel - kMaxStep;
  const int ns = map.ns;
  const StepTable& steps = kSign > 0 ? kUpward : kDownward;
  const __m256i table = load_bits(steps.step);

  // Heights as the lowest bit that the next column is looked for at.
  alignas(32) int middle[kRowLanes];
  for (int& at : middle) at = kNowhere;
  const std::uint32_t* row0 = columns.bits[ns] + kMid;
  const auto follow_one = [&](std::uint32_t surface, int at) {
    const std::uint32_t five = at >= 0 && at < 32 ? surface >> at & 31u : 0u;
    return at + steps.step[five] - kMaxStep;
  };
  int left = middle[kMid] = follow_one(row0[0], kFirst), right = left;
  for (int i = 1; i <= ns; ++i) {
    middle[kMid + i] = right = follow_one(row0[i], right);
    middle[kMid - i] = left = follow_one(row0[-i], left);
  }

  NarrowRows out(map, trace, middle[kMid] - kFirst);
  __m256i above0 = load_bits(middle), above1 = load_bits(middle + 8), below0 = above0,
          below1 = above1;
  for (int j = 0; j <= ns; ++j) {
    if (j > 0) {
      above0 = follow(load_bits(columns.bits[ns + j]), above0, table);
      above1 = follow(load_bits(columns.bits[ns + j] + 8), above1, table);
      below0 = follow(load_bits(columns.bits[ns - j]), below0, table);
      below1 = follow(load_bits(columns.bits[ns - j] + 8), below1, table);
    }
    out.take(j,
             _mm256_sub_epi8(as_bytes(above0, above1, below0, below1), _mm256_set1_epi8(kFirst)));
  }
  out.finish();
}

template <int kSign, int kStride>
void trace_narrow(const ColumnBits::Windows& windows, int trace, HeightMap& map) noexcept {
  map.lanes = kRowLanes;
  NarrowColumns columns;
  if (!trace_single<kSign, kStride>(windows, trace, map, columns)) {
    trace_columns<kSign>(columns, trace, map);
  }
}

/// A map of 32 lanes, stride 1, row by row.
template <int kSign>
void trace_wide(const ColumnBits::Windows& windows, int trace, HeightMap& map) noexcept {
  constexpr int kLanes = HeightMap::kMaxLanes, kMid = kLanes / 2, kFirst = kLevel - kMaxStep;
  map.lanes = kLanes;
  const int ns = map.ns;
  const __m128i down = _mm_cvtsi32_si128(static_cast<int>(windows.shift));
  const __m128i up = _mm_cvtsi32_si128(32 - static_cast<int>(windows.shift));
  const StepTable& steps = kSign > 0 ? kUpward : kDownward;
  const __m256i table = load_bits(steps.step);
  struct Row {
    __m256i part[4];
  };
  const auto surface = [&](int j) {
    const std::uint32_t* lower = windows.words + j * windows.row - kMid;
    Row row;
    for (int k = 0; k < 4; ++k) {
      row.part[k] = surface_of<kSign>(lower + 8 * k, lower + windows.plane + 8 * k, down, up);
    }
    return row;
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
    const __m256i packed =
        _mm256_permutevar8x32_epi32(_mm256_packs_epi16(_mm256_packs_epi32(at.part[0], at.part[1]),
                                                       _mm256_packs_epi32(at.part[2], at.part[3])),
                                    _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
    const __m256i h = _mm256_sub_epi8(packed, _mm256_set1_epi8(kFirst));
    const __m256i beyond = _mm256_or_si256(outside, _mm256_cmpgt_epi8(_mm256_abs_epi8(h), limit));
    _mm256_store_si256(reinterpret_cast<__m256i*>(map.height.data() + (ns + j) * kLanes),
                       _mm256_blendv_epi8(h, none, beyond));
  };

  alignas(32) std::uint32_t row0[kLanes];
  const Row middle_row = surface(0);
  alignas(32) int middle[kLanes];
  for (int k = 0; k < 4; ++k) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(row0 + 8 * k), middle_row.part[k]);
    _mm256_store_si256(reinterpret_cast<__m256i*>(middle + 8 * k), _mm256_set1_epi32(kNowhere));
  }
  const auto follow_one = [&](std::uint32_t bits, int at) {
    const std::uint32_t five = at >= 0 && at < 32 ? bits >> at & 31u : 0u;
    return at + steps.step[five] - kMaxStep;
  };
  int left = middle[kMid] = follow_one(row0[kMid], kFirst), right = left;
  for (int i = 1; i <= ns; ++i) {
    middle[kMid + i] = right = follow_one(row0[kMid + i], right);
    middle[kMid - i] = left = follow_one(row0[kMid - i], left);
  }
  Row above, below;
  for (int k = 0; k < 4; ++k) above.part[k] = below.part[k] = load_bits(middle + 8 * k);
  take(0, above);
  for (int j = 1; j <= ns; ++j) {
    const Row upper = surface(j), lower = surface(-j);
    for (int k = 0; k < 4; ++k) {
      above.part[k] = follow(upper.part[k], above.part[k], table);
      below.part[k] = follow(lower.part[k], below.part[k], table);
    }
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
    const __m256i uneven =
        _mm256_cmpgt_epi8(_mm256_abs_epi8(_mm256_max_epi8(sum, _mm256_set1_epi8(-127))),
                          _mm256_set1_epi8(kMaxUneven));
    even = _mm256_min_epu8(even,
                           _mm256_or_si256(ring, _mm256_xor_si256(uneven, _mm256_set1_epi8(-1))));
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

}  // namespace

}  // namespace sulcus

#include "engine/normals/coarse_kernel_avx2.inl"
#include "engine/normals/tile_kernels_avx2.inl"

namespace sulcus {

namespace {

// --- Fits ---------------------------------------------------------------------------------------

inline __m256i sixteen(const signed char* height) {
  return _mm256_cvtepi8_epi16(_mm_load_si128(reinterpret_cast<const __m128i*>(height)));
}

void fit_map(const HeightMap& map, const QuadricFilter& filter, QuadricSums& out) noexcept {
  // The filters of 1, i, i^2 and j^2 are even in j, those of j and i j odd: rows +j and -j are
  // taken together.
  const int rings = filter.rings;
  __m256i sums[kQuadric] = {};
  const auto add = [&](int f, __m256i h, int place) {
    sums[f] =
        _mm256_add_epi32(sums[f], _mm256_madd_epi16(h, load_bits(&filter.coefficient[f][place])));
  };
  for (int chunk = 0; chunk < map.lanes; chunk += 16) {
    const signed char* middle = map.height.data() + map.ns * map.lanes + chunk;
    const int place = rings * map.lanes + chunk;
    const __m256i h0 = sixteen(middle);
    for (const int f : {0, 1, 3, 5}) add(f, h0, place);
    for (int j = 1; j <= rings; ++j) {
      const __m256i above = sixteen(middle + j * map.lanes),
                    below = sixteen(middle - j * map.lanes);
      const __m256i even = _mm256_add_epi16(above, below), odd = _mm256_sub_epi16(above, below);
      for (const int f : {0, 1, 3, 5}) add(f, even, place + j * map.lanes);
      for (const int f : {2, 4}) add(f, odd, place + j * map.lanes);
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

constexpr MapKernels kAvx2{
    "avx2",          coarse_sums,   trace_map,          read_tile,     cut_map,
    is_even,         fit_map,       surfaces_of,        feet_of,       largest_residual,
    half_sums,       sums_on_plane, residuals_on_plane, gather_points, tilted_moments,
    tilted_residuals};

}  // namespace

const MapKernels* avx2_map_kernels() noexcept {
  return __builtin_cpu_supports("avx2") ? &kAvx2 : nullptr;
}

}  // namespace sulcus

#else

namespace sulcus {
const MapKernels* avx2_map_kernels() noexcept { return nullptr; }
}  // namespace sulcus

#endif
