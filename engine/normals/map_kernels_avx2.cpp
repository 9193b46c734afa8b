// Compiled for AVX2. Leaves no inline code for others to be linked with (test
// Avx2KernelsKeepToThemselves).
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

// --- Coarse normal ------------------------------------------------------------------------------

/// The 21 rows of five voxels as bytes, eight to a row and four rows to a vector: where a row's
/// bits are fetched from among the bytes of three vectors (0 and 1 in the first, and so on), and
/// what its voxels count.
struct CoarseTable {
  alignas(32) signed char from[6][32];
  alignas(32) signed char weight[3][6][32];
};
constexpr CoarseTable make_coarse_table() {
  // (j, k) of the rows, as in coarse_sums below: j = -2 to 1 of k = -2 to 1, then j = 2, then k
  // = 2.
  constexpr int kNoRow = 100;
  constexpr int kRows[6][4][2] = {
      {{-1, -2}, {0, -2}, {1, -2}, {-2, -1}}, {{-1, -1}, {0, -1}, {1, -1}, {-2, 0}},
      {{-1, 0}, {0, 0}, {1, 0}, {-2, 1}},     {{-1, 1}, {0, 1}, {1, 1}, {kNoRow, 0}},
      {{2, -1}, {2, 0}, {2, 1}, {kNoRow, 0}}, {{-1, 2}, {0, 2}, {1, 2}, {kNoRow, 0}}};
  CoarseTable table{};
  for (int vector = 0; vector < 6; ++vector) {
    for (int lane = 0; lane < 32; ++lane) {
      const int j = kRows[vector][lane / 8][0], k = kRows[vector][lane / 8][1], i = lane % 8 - 2;
      table.from[vector][lane] = -1;
      if (j == kNoRow) continue;
      // Four bytes for each k, the first of them j = -2, or j = 2 in the second vector.
      const int byte = vector == 5 ? j + 2 : vector == 4 ? 4 * (k + 2) : 4 * (k + 2) + j + 2;
      table.from[vector][lane] = static_cast<signed char>(byte);
      const int d2 = i * i + j * j + k * k;
      if (i > 2 || d2 > 6) continue;
      const int weight = kCoarseWeight.begin()[d2];
      table.weight[0][vector][lane] = static_cast<signed char>(i * weight);
      table.weight[1][vector][lane] = static_cast<signed char>(j * weight);
      table.weight[2][vector][lane] = static_cast<signed char>(k * weight);
    }
  }
  return table;
}
constexpr CoarseTable kCoarse = make_coarse_table();

void coarse_sums(const ColumnBits::Windows& rows, std::array<std::int32_t, 3>& sums) noexcept {
  const __m128i down = _mm_cvtsi32_si128(static_cast<int>(rows.shift));
  const __m128i up = _mm_cvtsi32_si128(32 - static_cast<int>(rows.shift));
  const auto patterns = [&](int k) {  // of j = -2 to 5
    const std::uint32_t* w = rows.words + k * rows.row - 2;
    const __m256i five = _mm256_or_si256(_mm256_srl_epi32(load_bits(w), down),
                                         _mm256_sll_epi32(load_bits(w + rows.plane), up));
    return _mm256_and_si256(five, _mm256_set1_epi32(31));
  };
  const __m256i most = _mm256_packus_epi16(_mm256_packus_epi32(patterns(-2), patterns(-1)),
                                           _mm256_packus_epi32(patterns(0), patterns(1)));
  const __m256i last = patterns(2), last16 = _mm256_packus_epi32(last, last);
  const __m256i first4 = _mm256_permute4x64_epi64(most, 0x44);   // j = -2 to 1, twice
  const __m256i second4 = _mm256_permute4x64_epi64(most, 0xee);  // j = 2 and on
  const __m256i ahead = _mm256_permute4x64_epi64(_mm256_packus_epi16(last16, last16), 0x44);
  const __m256i bits = _mm256_set1_epi64x(0x1008040201), one = _mm256_set1_epi8(1);
  __m256i x = _mm256_setzero_si256(), y = x, z = x;
#pragma GCC unroll 6
  for (int v = 0; v < 6; ++v) {
    const __m256i from = v == 4 ? second4 : v == 5 ? ahead : first4;
    const __m256i row = _mm256_shuffle_epi8(from, load_bits(kCoarse.from[v]));
    const __m256i solid = _mm256_min_epu8(_mm256_and_si256(row, bits), one);
    x = _mm256_add_epi16(x, _mm256_maddubs_epi16(solid, load_bits(kCoarse.weight[0][v])));
    y = _mm256_add_epi16(y, _mm256_maddubs_epi16(solid, load_bits(kCoarse.weight[1][v])));
    z = _mm256_add_epi16(z, _mm256_maddubs_epi16(solid, load_bits(kCoarse.weight[2][v])));
  }
  const __m256i ones = _mm256_set1_epi16(1);
  const __m256i xy = _mm256_hadd_epi32(_mm256_madd_epi16(x, ones), _mm256_madd_epi16(y, ones));
  const __m256i zz = _mm256_madd_epi16(z, ones);
  const __m256i all = _mm256_hadd_epi32(xy, _mm256_hadd_epi32(zz, zz));
  alignas(16) std::int32_t total[4];
  _mm_store_si128(reinterpret_cast<__m128i*>(total),
                  _mm_add_epi32(_mm256_castsi256_si128(all), _mm256_extracti128_si256(all, 1)));
  __builtin_memcpy(&sums, total, sizeof sums);
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

// --- Tiles of a leaf ----------------------------------------------------------------------------

/// Heights of a row of a tile, and its columns that do not count.
template <int kSign>
inline __m256i tile_row(const std::uint32_t* lower, const std::uint32_t* upper, __m128i down,
                        __m128i up) {
  constexpr int kSpan = HeightTile::kHighest - HeightTile::kLowest + 1;
  const __m256i known = _mm256_set1_epi32(0x7ffffffe);
  const __m256i keeps = _mm256_set1_epi32(
      static_cast<int>(((1u << kSpan) - 1u) << (HeightTile::kBelow + HeightTile::kLowest)));
  const __m256i zero = _mm256_setzero_si256();
  const auto eight = [&](int k) {
    const __m256i s =
        _mm256_and_si256(surface_of<kSign>(lower + 8 * k, upper + 8 * k, down, up), known);
    const __m256i others = _mm256_and_si256(s, _mm256_add_epi32(s, _mm256_set1_epi32(-1)));
    const __m256i one = _mm256_cmpeq_epi32(others, zero);
    const __m256i kept =
        _mm256_andnot_si256(_mm256_cmpeq_epi32(_mm256_and_si256(s, keeps), zero), one);
    // The exponent of a power of two is its bit.
    const __m256i exponent = _mm256_srli_epi32(_mm256_castps_si256(_mm256_cvtepi32_ps(s)), 23);
    const __m256i height = _mm256_sub_epi32(exponent, _mm256_set1_epi32(127 + HeightTile::kBelow));
    return _mm256_blendv_epi8(_mm256_set1_epi32(HeightMap::kNone), height, kept);
  };
  const __m256i a = eight(0), b = eight(1), c = eight(2);
  return _mm256_permutevar8x32_epi32(
      _mm256_packs_epi16(_mm256_packs_epi32(a, b),
                         _mm256_packs_epi32(c, _mm256_set1_epi32(HeightMap::kNone))),
      _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
}

/// Any of the lanes within `ns` of each.
inline std::uint32_t any_within(std::uint32_t lanes, int ns) {
  std::uint32_t any = lanes;
  for (int d = 1; d <= ns; ++d) any |= lanes << d | lanes >> d;
  return any;
}

template <int kSign>
inline void read_heights(const ColumnBits::Windows& windows, HeightTile& tile) {
  constexpr int kEdge = HeightTile::kEdge, kMargin = HeightTile::kMargin;
  const int ns = tile.ns, rows = kEdge + 2 * ns;
  const __m128i down = _mm_cvtsi32_si128(static_cast<int>(windows.shift));
  const __m128i up = _mm_cvtsi32_si128(32 - static_cast<int>(windows.shift));
  const __m256i none = _mm256_set1_epi8(HeightMap::kNone), most = _mm256_set1_epi8(kMaxStep);
  const auto jumps = [&](__m256i a, __m256i b) {
    return static_cast<std::uint32_t>(
        _mm256_movemask_epi8(_mm256_cmpgt_epi8(_mm256_abs_epi8(_mm256_subs_epi8(a, b)), most)));
  };
  std::uint32_t gaps[HeightTile::kRows], falls[HeightTile::kRows], beside[HeightTile::kRows];
  __m256i before = none;
  for (int r = 0; r < rows; ++r) {
    const std::uint32_t* lower = windows.words + (r - ns) * windows.row - kMargin;
    const __m256i h = tile_row<kSign>(lower, lower + windows.plane, down, up);
    _mm256_store_si256(reinterpret_cast<__m256i*>(tile.height[r]), h);
    gaps[r] = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(h, none)));
    falls[r] = jumps(h, before);  // from the row before
    // From each lane to the next; across the halves the two are loaded as they were stored.
    const __m256i next = load_bits(tile.height[r] + 1);
    beside[r] = jumps(h, next);
    before = h;
  }
  for (int v = 0; v < kEdge; ++v) {
    std::uint32_t bad = gaps[v];
    for (int r = v + 1; r <= v + 2 * ns; ++r) bad |= gaps[r] | falls[r];
    bad = any_within(bad, ns);
    for (int d = 1; d <= ns; ++d) bad |= beside[ns + v] << d | beside[ns + v] >> (d - 1);
    tile.sound[v] = static_cast<std::uint8_t>(~bad >> kMargin);
  }
}

/// Sums over a row of i^a times height, for the eight columns of the leaf.
struct RowMoments {
  alignas(32) std::int32_t of[5][HeightTile::kRows][HeightTile::kEdge];
};

/// Two rows at a time: the heights i to either side are added, and subtracted, and taken in pairs.
template <int kPairs>
inline void row_moments(const HeightTile& tile, RowMoments& moments) {
  const int ns = tile.ns, rows = HeightTile::kEdge + 2 * ns;
  alignas(32) std::int16_t factor[5][4][2];
  for (int pair = 0; pair < 4; ++pair) {
    for (int half = 0; half < 2; ++half) {
      const int i = 2 * pair + 1 + half;
      int power = i <= ns ? 1 : 0;
      for (int a = 0; a < 5; ++a, power *= i)
        factor[a][pair][half] = static_cast<std::int16_t>(power);
    }
  }
  const auto factors = [&](int a, int pair) {
    std::int32_t both;
    __builtin_memcpy(&both, factor[a][pair], sizeof both);
    return _mm256_set1_epi32(both);
  };
  for (int r = 0; r < rows; r += 2) {
    const signed char* first = tile.height[r] + HeightTile::kMargin;
    const signed char* second = first + HeightTile::kLanes;
    const auto at = [&](int i) {
      const __m128i low = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(first + i));
      const __m128i high = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(second + i));
      return _mm256_cvtepi8_epi16(_mm_unpacklo_epi64(low, high));
    };
    __m256i low[5], high[5];
    const __m256i middle = at(0);
    low[0] = _mm256_madd_epi16(_mm256_unpacklo_epi16(middle, _mm256_setzero_si256()),
                               _mm256_set1_epi32(1));
    high[0] = _mm256_madd_epi16(_mm256_unpackhi_epi16(middle, _mm256_setzero_si256()),
                                _mm256_set1_epi32(1));
    for (int a = 1; a < 5; ++a) low[a] = high[a] = _mm256_setzero_si256();
#pragma GCC unroll 4
    for (int pair = 0; pair < kPairs; ++pair) {
      const int i = 2 * pair + 1;
      const __m256i right0 = at(i), left0 = at(-i), right1 = at(i + 1), left1 = at(-i - 1);
      const __m256i even0 = _mm256_add_epi16(right0, left0), odd0 = _mm256_sub_epi16(right0, left0);
      const __m256i even1 = _mm256_add_epi16(right1, left1), odd1 = _mm256_sub_epi16(right1, left1);
      const __m256i even_low = _mm256_unpacklo_epi16(even0, even1),
                    even_high = _mm256_unpackhi_epi16(even0, even1),
                    odd_low = _mm256_unpacklo_epi16(odd0, odd1),
                    odd_high = _mm256_unpackhi_epi16(odd0, odd1);
#pragma GCC unroll 5
      for (int a = 0; a < 5; ++a) {
        const __m256i f = factors(a, pair);
        low[a] = _mm256_add_epi32(low[a], _mm256_madd_epi16(a % 2 == 0 ? even_low : odd_low, f));
        high[a] =
            _mm256_add_epi32(high[a], _mm256_madd_epi16(a % 2 == 0 ? even_high : odd_high, f));
      }
    }
    for (int a = 0; a < 5; ++a) {
      _mm256_store_si256(reinterpret_cast<__m256i*>(moments.of[a][r]),
                         _mm256_permute2x128_si256(low[a], high[a], 0x20));
      _mm256_store_si256(reinterpret_cast<__m256i*>(moments.of[a][r + 1]),
                         _mm256_permute2x128_si256(low[a], high[a], 0x31));
    }
  }
}

/// The filter's sums of all maps of a tile. The moments i^a j^b of a map follow from those of the
/// map one row before: a row leaves, j becomes j - 1, a row comes.
inline void tile_sums(const RowMoments& rows, HeightTile& tile) {
  const int ns = tile.ns;
  const __m256i at_centre = _mm256_set1_epi32(taper_of(ns).centre);
  const __m128i fall = _mm_cvtsi32_si128(taper_of(ns).fall - 1);  // 1 or 2, as a shift
  __m256i m[5][5];
  const auto row = [&](int a, int r) {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(rows.of[a][r]));
  };
#pragma GCC unroll 5
  for (int a = 0; a < 5; ++a) {
    for (int b = 0; a + b < 5; ++b) m[a][b] = _mm256_setzero_si256();
    for (int j = -ns; j <= ns; ++j) {
      __m256i part = row(a, ns + j);
      const __m256i factor = _mm256_set1_epi32(j);
#pragma GCC unroll 5
      for (int b = 0; a + b < 5; ++b) {
        m[a][b] = _mm256_add_epi32(m[a][b], part);
        if (a + b < 4) part = _mm256_mullo_epi32(part, factor);
      }
    }
  }
  const __m256i leaving = _mm256_set1_epi32(-ns), coming = _mm256_set1_epi32(ns);
  for (int v = 0;; ++v) {
    const auto put = [&](int f, __m256i main, __m256i ii, __m256i jj) {
      const __m256i sum = _mm256_sub_epi32(_mm256_mullo_epi32(at_centre, main),
                                           _mm256_sll_epi32(_mm256_add_epi32(ii, jj), fall));
      _mm256_store_si256(reinterpret_cast<__m256i*>(tile.sums[v][f]), sum);
    };
    put(0, m[0][0], m[2][0], m[0][2]);
    put(1, m[1][0], m[3][0], m[1][2]);
    put(2, m[0][1], m[2][1], m[0][3]);
    put(3, m[2][0], m[4][0], m[2][2]);
    put(4, m[1][1], m[3][1], m[1][3]);
    put(5, m[0][2], m[2][2], m[0][4]);
    if (v == HeightTile::kEdge - 1) break;
#pragma GCC unroll 5
    for (int a = 0; a < 5; ++a) {
      __m256i gone = row(a, v), come = row(a, v + 2 * ns + 1);
#pragma GCC unroll 5
      for (int b = 0; a + b < 5; ++b) {
        m[a][b] = _mm256_sub_epi32(m[a][b], gone);
        if (a + b < 4) gone = _mm256_mullo_epi32(gone, leaving);
      }
      // (j - 1)^b of all b from j^b, by differences.
#pragma GCC unroll 4
      for (int pass = 1; pass < 5 - a; ++pass) {
#pragma GCC unroll 4
        for (int b = 4 - a; b >= pass; --b) m[a][b] = _mm256_sub_epi32(m[a][b], m[a][b - 1]);
      }
#pragma GCC unroll 5
      for (int b = 0; a + b < 5; ++b) {
        m[a][b] = _mm256_add_epi32(m[a][b], come);
        if (a + b < 4) come = _mm256_mullo_epi32(come, coming);
      }
    }
  }
}

void read_tile(const ColumnBits::Windows& columns, HeightTile& tile) noexcept {
  tile.sign > 0 ? read_heights<1>(columns, tile) : read_heights<-1>(columns, tile);
  RowMoments rows;
  switch ((tile.ns + 1) / 2) {
    case 1:
      row_moments<1>(tile, rows);
      break;
    case 2:
      row_moments<2>(tile, rows);
      break;
    case 3:
      row_moments<3>(tile, rows);
      break;
    default:
      row_moments<4>(tile, rows);
  }
  tile_sums(rows, tile);
}

bool cut_map(const HeightTile& tile, int u, int v, int w, int trace, HeightMap& map) noexcept {
  const int ns = tile.ns;
  const int centre = tile.height[ns + v][HeightTile::kMargin + u] - w;
  if ((tile.sound[v] >> u & 1) == 0 || centre < -kMaxStep || centre > kMaxStep) return false;
  const int reach = trace < HeightTile::kReach ? trace : HeightTile::kReach;
  const __m256i level = _mm256_set1_epi8(static_cast<char>(w));
  const __m256i twice_centre = _mm256_set1_epi8(static_cast<char>(2 * centre));
  const __m256i outside =
      _mm256_cmpgt_epi8(lane_distance(), _mm256_set1_epi8(static_cast<char>(ns)));
  const __m256i most = _mm256_set1_epi8(kMaxUneven),
                limit = _mm256_set1_epi8(static_cast<char>(reach));
  const __m256i none = _mm256_set1_epi8(HeightMap::kNone);
  const auto beyond = [](__m256i a, __m256i bound) {
    return _mm256_subs_epu8(_mm256_abs_epi8(a), bound);
  };
  __m256i uneven = _mm256_setzero_si256(), far = uneven;
  signed char* out = &map.height.front() + ns * kRowLanes;
  const signed char* middle = tile.height[ns + v] + u;  // lane -kMargin of the map
  for (int j = 0; j <= ns; ++j) {
    const __m256i rows =
        _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(middle - j * HeightTile::kLanes),
                            reinterpret_cast<const __m128i*>(middle + j * HeightTile::kLanes));
    const __m256i h = _mm256_subs_epi8(rows, level);
    const __m256i opposite = _mm256_shuffle_epi8(_mm256_permute2x128_si256(h, h, 1), mirror());
    uneven = _mm256_or_si256(
        uneven, beyond(_mm256_subs_epi8(_mm256_adds_epi8(h, opposite), twice_centre), most));
    far = _mm256_or_si256(far, beyond(h, limit));
    const __m256i stored = _mm256_blendv_epi8(h, none, outside);
    _mm_store_si128(reinterpret_cast<__m128i*>(out + j * kRowLanes),
                    _mm256_castsi256_si128(stored));
    _mm_store_si128(reinterpret_cast<__m128i*>(out - j * kRowLanes),
                    _mm256_extracti128_si256(stored, 1));
  }
  if (_mm256_testc_si256(outside, far) == 0) return false;
  map.lanes = kRowLanes;
  finish_whole(uneven, outside, trace, centre, map);
  return true;
}

bool is_even(const HeightTile& tile, int u, int v, int w, int trace) noexcept {
  const int ns = tile.ns;
  const int height = tile.height[ns + v][HeightTile::kMargin + u], centre = height - w;
  if ((tile.sound[v] >> u & 1) == 0 || centre < -kMaxStep || centre > kMaxStep) return false;
  const int reach = trace < HeightTile::kReach ? trace : HeightTile::kReach;
  const __m256i twice = _mm256_set1_epi8(static_cast<char>(2 * height));
  __m256i uneven = _mm256_setzero_si256(), highest = _mm256_set1_epi8(-128),
          lowest = _mm256_set1_epi8(127);
  const signed char* middle = tile.height[ns + v] + u;
  for (int j = 0; j <= ns; ++j) {
    const __m256i h =
        _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(middle - j * HeightTile::kLanes),
                            reinterpret_cast<const __m128i*>(middle + j * HeightTile::kLanes));
    const __m256i opposite = _mm256_shuffle_epi8(_mm256_permute2x128_si256(h, h, 1), mirror());
    const __m256i sum = _mm256_subs_epi8(_mm256_adds_epi8(h, opposite), twice);
    uneven = _mm256_max_epu8(uneven, _mm256_abs_epi8(sum));
    highest = _mm256_max_epi8(highest, h);
    lowest = _mm256_min_epi8(lowest, h);
  }
  const __m256i outside =
      _mm256_cmpgt_epi8(lane_distance(), _mm256_set1_epi8(static_cast<char>(ns)));
  const __m256i bad = _mm256_or_si256(
      _mm256_or_si256(_mm256_cmpgt_epi8(highest, _mm256_set1_epi8(static_cast<char>(w + reach))),
                      _mm256_cmpgt_epi8(_mm256_set1_epi8(static_cast<char>(w - reach)), lowest)),
      _mm256_subs_epu8(uneven, _mm256_set1_epi8(kMaxUneven)));
  return _mm256_testc_si256(outside, bad) != 0;
}

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
