// Reads tiles of a leaf and cuts maps out of them, for AVX2 and AVX-512: loops of map_kernels.hpp.

#pragma once

#include "engine/normals/kernels/tile_sums.hpp"
#include "engine/normals/kernels/trace_maps.hpp"

namespace sulcus {

namespace {

inline constexpr int kTileSpan = HeightTile::kHighest - HeightTile::kLowest + 1;
/// Surfaces that are known in a column: at the ends of the window the next voxel is not. And those
/// whose heights a tile keeps.
inline constexpr int kKnown = 0x7ffffffe;
inline constexpr int kKeeps =
    static_cast<int>(((1u << kTileSpan) - 1u) << (HeightTile::kBelow + HeightTile::kLowest));

/// Heights of a row of a tile; kNone of its columns that do not count.
#ifdef __AVX512F__
template <int kSign>
inline __m256i tile_row(const std::uint32_t* lower, const std::uint32_t* upper, unsigned shift) {
  const auto sixteen = [&](int first, __mmask16 read) {
    const __m512i w = _mm512_shrdv_epi32(_mm512_maskz_loadu_epi32(read, lower + first),
                                         _mm512_maskz_loadu_epi32(read, upper + first),
                                         _mm512_set1_epi32(static_cast<int>(shift)));
    const __m512i s = _mm512_and_si512(
        _mm512_andnot_si512(kSign > 0 ? _mm512_srli_epi32(w, 1) : _mm512_slli_epi32(w, 1), w),
        _mm512_set1_epi32(kKnown));
    const __m512i others = _mm512_add_epi32(s, _mm512_set1_epi32(-1));
    const __mmask16 one = _mm512_testn_epi32_mask(s, others);
    const __mmask16 kept = _mm512_mask_test_epi32_mask(one, s, _mm512_set1_epi32(kKeeps));
    // The exponent of a power of two is its bit.
    const __m512i exponent = _mm512_srli_epi32(_mm512_castps_si512(_mm512_cvtepi32_ps(s)), 23);
    const __m512i height = _mm512_sub_epi32(exponent, _mm512_set1_epi32(127 + HeightTile::kBelow));
    return _mm512_mask_cvtepi32_epi8(_mm_set1_epi8(HeightMap::kNone), kept, height);
  };
  return _mm256_set_m128i(sixteen(16, 0x00ff), sixteen(0, 0xffff));
}
#else
template <int kSign>
inline __m256i tile_row(const std::uint32_t* lower, const std::uint32_t* upper, unsigned shift) {
  const __m128i down = _mm_cvtsi32_si128(static_cast<int>(shift));
  const __m128i up = _mm_cvtsi32_si128(32 - static_cast<int>(shift));
  const __m256i known = _mm256_set1_epi32(kKnown), keeps = _mm256_set1_epi32(kKeeps);
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
#endif

/// Of all maps of a tile, eight columns of eight rows.
struct TileBytes {
  alignas(64) std::uint64_t highest[HeightTile::kEdge], lowest[HeightTile::kEdge];
  alignas(64) std::uint64_t even_rings[HeightTile::kEdge]{};
};

/// Highest and lowest of rows, then across. Where columns do not count maps are not sound.
inline void find_extremes(const TileWords& words, int ns, TileBytes& bytes) {
  for (int v = 0; v < HeightTile::kEdge; v += kRowsAtOnce) {
    RowBytes highest[3], lowest[3];
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t* const rows = words.of[k] + v;
      highest[k] = lowest[k] = load_rows(rows);
      for (int r = 1; r <= 2 * ns; ++r) {
        const RowBytes row = load_rows(rows + r);
        highest[k] = higher(highest[k], row);
        lowest[k] = lower(lowest[k], row);
      }
    }
    RowBytes most = highest[1], least = lowest[1];
    for (int i = 1; i <= ns; ++i) {
      const ByteShift right(i), left(8 - i);
      most = higher(most, higher(from_byte(highest[1], highest[2], right),
                                 from_byte(highest[0], highest[1], left)));
      least = lower(least, lower(from_byte(lowest[1], lowest[2], right),
                                 from_byte(lowest[0], lowest[1], left)));
    }
    store_rows(most, bytes.highest + v);
    store_rows(least, bytes.lowest + v);
  }
}

/// Even rings. Sums of bytes stay in a byte where columns count.
inline void compare_opposites(const TileWords& words, int ns, TileBytes& bytes) {
  for (int v = 0; v < HeightTile::kEdge; v += kRowsAtOnce) {
    const std::uint64_t* const middle[3] = {words.of[0] + ns + v, words.of[1] + ns + v,
                                            words.of[2] + ns + v};
    const auto row = [&](int k, int j) { return load_rows(middle[k] + j); };
    const RowBytes centre = row(1, 0), twice = plus(centre, centre);
    RowBytes most = twice, least = twice;
    RowBytes rings = minus(centre, centre);
    const auto take = [&](RowBytes a, RowBytes b) {
      const RowBytes sum = plus(a, b);
      most = higher(most, sum);
      least = lower(least, sum);
    };
    for (int ring = 1; ring <= ns; ++ring) {
      const RowBytes above[3] = {row(0, ring), row(1, ring), row(2, ring)},
                     below[3] = {row(0, -ring), row(1, -ring), row(2, -ring)};
      take(above[1], below[1]);
      for (int i = 1; i <= ring; ++i) {
        const ByteShift right(i), left(8 - i);
        take(from_byte(above[1], above[2], right), from_byte(below[0], below[1], left));
        take(from_byte(above[0], above[1], left), from_byte(below[1], below[2], right));
      }
      const ByteShift right(ring), left(8 - ring);
      for (int j = 1 - ring; j < ring; ++j) {
        take(from_byte(row(1, j), row(2, j), right), from_byte(row(0, -j), row(1, -j), left));
      }
      rings = count_where_even(rings, minus(most, twice), minus(twice, least), most_uneven(ring));
    }
    store_rows(rings, bytes.even_rings + v);
  }
}

/// Two rows of columns at a time, byte by byte.
inline void put_columns(const TileWords& words, const TileBytes& bytes, HeightTile& tile) {
  const auto two = [](const std::uint64_t* rows) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(rows));
  };
  const __m128i bit = _mm_set1_epi64x(static_cast<std::int64_t>(0x8040201008040201));
  const __m128i far = _mm_set1_epi8(HeightTile::kUnsound.highest);
  for (int v = 0; v < HeightTile::kEdge; v += 2) {
    const __m128i sound = _mm_unpacklo_epi64(_mm_set1_epi8(static_cast<char>(tile.sound[v])),
                                             _mm_set1_epi8(static_cast<char>(tile.sound[v + 1])));
    const __m128i is_sound = _mm_cmpeq_epi8(_mm_and_si128(sound, bit), bit);
    const __m128i height = two(words.of[1] + tile.ns + v), lowest = two(bytes.lowest + v);
    const __m128i highest = _mm_blendv_epi8(far, two(bytes.highest + v), is_sound);
    const __m128i rings = _mm_and_si128(two(bytes.even_rings + v), is_sound);
    const auto put = [&](int row, __m128i heights, __m128i others) {
      auto* const to = reinterpret_cast<__m128i*>(tile.columns + row * HeightTile::kEdge);
      _mm_store_si128(to, _mm_unpacklo_epi16(heights, others));
      _mm_store_si128(to + 1, _mm_unpackhi_epi16(heights, others));
    };
    put(v, _mm_unpacklo_epi8(height, highest), _mm_unpacklo_epi8(lowest, rings));
    put(v + 1, _mm_unpackhi_epi8(height, highest), _mm_unpackhi_epi8(lowest, rings));
  }
}

template <int kSign>
inline void read_heights(const ColumnBits::Windows& windows, HeightTile& tile, TileWords& words) {
  constexpr int kEdge = HeightTile::kEdge, kMargin = HeightTile::kMargin;
  const int ns = tile.ns, rows = kEdge + 2 * ns;
  const __m256i none = _mm256_set1_epi8(HeightMap::kNone), most = _mm256_set1_epi8(kMaxStep);
  const auto jumps = [&](__m256i a, __m256i b) {
    return static_cast<std::uint32_t>(
        _mm256_movemask_epi8(_mm256_cmpgt_epi8(_mm256_abs_epi8(_mm256_subs_epi8(a, b)), most)));
  };
  // A bit for each lane: without a height; or with a step too high from the row before; and with
  // one to the next lane.
  std::uint32_t gaps[HeightTile::kRows]{}, broken[HeightTile::kRows], beside[HeightTile::kRows];
  __m256i before = none;
  for (int r = 0; r < rows; ++r) {
    const std::uint32_t* lower = windows.words + (r - ns) * windows.row - kMargin;
    const __m256i h = tile_row<kSign>(lower, lower + windows.plane, windows.shift);
    _mm256_store_si256(reinterpret_cast<__m256i*>(tile.height[r]), h);
    words.of[0][r] = static_cast<std::uint64_t>(_mm256_extract_epi64(h, 0));
    words.of[1][r] = static_cast<std::uint64_t>(_mm256_extract_epi64(h, 1));
    words.of[2][r] = static_cast<std::uint64_t>(_mm256_extract_epi64(h, 2));
    gaps[r] = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(h, none)));
    broken[r] = gaps[r] | jumps(h, before);
    // From each lane to the next, across the halves too.
    const __m256i next = _mm256_alignr_epi8(_mm256_permute2x128_si256(h, h, 0x81), h, 1);
    beside[r] = jumps(h, next);
    before = h;
  }
  for (int r = rows; r < TileWords::kRoom; ++r) {
    words.of[0][r] = words.of[1][r] = words.of[2][r] = 0;
  }
  // All eight rows of the leaf side by side: in a map's rows, then its columns.
  __m256i bad = load_bits(gaps), across = load_bits(beside);
  for (int r = 1; r <= 2 * ns; ++r) {
    bad = _mm256_or_si256(bad, load_bits(broken + r));
    across = _mm256_or_si256(across, load_bits(beside + r));
  }
  __m256i near = bad;
  for (int d = 1; d <= ns; ++d) {
    const __m256i left = _mm256_or_si256(bad, across);
    const __m128i count = _mm_cvtsi32_si128(d), less = _mm_cvtsi32_si128(d - 1);
    near = _mm256_or_si256(near, _mm256_sll_epi32(left, count));
    near = _mm256_or_si256(near, _mm256_srl_epi32(bad, count));
    near = _mm256_or_si256(near, _mm256_srl_epi32(across, less));
  }
  alignas(32) std::uint32_t unsound[kEdge];
  _mm256_store_si256(reinterpret_cast<__m256i*>(unsound), near);
  for (int v = 0; v < kEdge; ++v) tile.sound[v] = static_cast<std::uint8_t>(~unsound[v] >> kMargin);
}

inline void read_tile(const ColumnBits::Windows& columns, HeightTile& tile) noexcept {
  TileWords words;
  tile.sign > 0 ? read_heights<1>(columns, tile, words) : read_heights<-1>(columns, tile, words);
  std::uint64_t sound;
  __builtin_memcpy(&sound, tile.sound, sizeof sound);
  if (sound == 0) {
    for (auto& column : tile.columns) column = HeightTile::kUnsound;
    return;
  }
  TileBytes bytes;
  find_extremes(words, tile.ns, bytes);
  if (tile.wants_even_rings) compare_opposites(words, tile.ns, bytes);
  put_columns(words, bytes, tile);
  tile_sums(words, tile);
}

inline bool cut_map(const HeightTile& tile, int u, int v, int w, int trace,
                    HeightMap& map) noexcept {
  const int ns = tile.ns;
  const int centre = tile.height[ns + v][HeightTile::kMargin + u] - w;
  if ((tile.sound[v] >> u & 1) == 0 || centre < -kMaxStep || centre > kMaxStep) return false;
  const int reach = trace < HeightTile::kReach ? trace : HeightTile::kReach;
  const __m256i level = _mm256_set1_epi8(static_cast<char>(w));
  const __m256i twice_centre = _mm256_set1_epi8(static_cast<char>(2 * centre));
  const __m256i outside =
      _mm256_cmpgt_epi8(lane_distance(), _mm256_set1_epi8(static_cast<char>(ns)));
  const __m256i most = _mm256_set1_epi8(kMostUnevenOfMany),
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

}  // namespace

}  // namespace sulcus
