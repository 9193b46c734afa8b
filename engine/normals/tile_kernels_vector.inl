// Tiles of a leaf: a part of map_kernels_vector.inl, whose helpers it uses.

namespace sulcus {

namespace {

constexpr int kTileSpan = HeightTile::kHighest - HeightTile::kLowest + 1;
/// Surfaces that are known in a column: at the ends of the window the next voxel is not. And those
/// whose heights a tile keeps.
constexpr int kKnown = 0x7ffffffe;
constexpr int kKeeps =
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

// Bytes of a tile, eight columns of as many rows as a vector holds, in words of eight.
#ifdef __AVX512F__
using RowBytes = __m512i;
constexpr int kRowsAtOnce = 8;
inline RowBytes load_rows(const std::uint64_t* words) { return _mm512_loadu_si512(words); }
inline void store_rows(RowBytes bytes, void* to) { _mm512_storeu_si512(to, bytes); }
inline RowBytes plus(RowBytes a, RowBytes b) { return _mm512_add_epi8(a, b); }
inline RowBytes minus(RowBytes a, RowBytes b) { return _mm512_sub_epi8(a, b); }
inline RowBytes higher(RowBytes a, RowBytes b) { return _mm512_max_epi8(a, b); }
inline RowBytes lower(RowBytes a, RowBytes b) { return _mm512_min_epi8(a, b); }
/// From byte n of the first word of each row on, n = 0 to 7.
struct ByteShift {
  explicit ByteShift(int n) : bits(_mm512_set1_epi64(8 * n)) {}
  __m512i bits;
};
inline RowBytes from_byte(RowBytes first, RowBytes second, const ByteShift& shift) {
  return _mm512_shrdv_epi64(first, second, shift.bits);
}
/// One more where neither is over `most`: once over it they stay there, as it does not rise.
inline RowBytes count_where_even(RowBytes rings, RowBytes over, RowBytes under, int most) {
  const __mmask64 even = _mm512_cmple_epi8_mask(_mm512_max_epi8(over, under),
                                                _mm512_set1_epi8(static_cast<char>(most)));
  return _mm512_mask_add_epi8(rings, even, rings, _mm512_set1_epi8(1));
}
#else
using RowBytes = __m256i;
constexpr int kRowsAtOnce = 4;
inline RowBytes load_rows(const std::uint64_t* words) { return load_bits(words); }
inline void store_rows(RowBytes bytes, void* to) {
  _mm256_storeu_si256(static_cast<__m256i*>(to), bytes);
}
inline RowBytes plus(RowBytes a, RowBytes b) { return _mm256_add_epi8(a, b); }
inline RowBytes minus(RowBytes a, RowBytes b) { return _mm256_sub_epi8(a, b); }
inline RowBytes higher(RowBytes a, RowBytes b) { return _mm256_max_epi8(a, b); }
inline RowBytes lower(RowBytes a, RowBytes b) { return _mm256_min_epi8(a, b); }
struct ByteShift {
  explicit ByteShift(int n) : down(_mm_cvtsi32_si128(8 * n)), up(_mm_cvtsi32_si128(64 - 8 * n)) {}
  __m128i down, up;
};
inline RowBytes from_byte(RowBytes first, RowBytes second, const ByteShift& shift) {
  return _mm256_or_si256(_mm256_srl_epi64(first, shift.down), _mm256_sll_epi64(second, shift.up));
}
inline RowBytes count_where_even(RowBytes rings, RowBytes over, RowBytes under, int most) {
  const __m256i uneven =
      _mm256_cmpgt_epi8(_mm256_max_epi8(over, under), _mm256_set1_epi8(static_cast<char>(most)));
  return _mm256_add_epi8(rings, _mm256_andnot_si256(uneven, _mm256_set1_epi8(1)));
}
#endif

/// The words of a tile's rows: columns -8 to -1, 0 to 7, 8 to 15.
struct TileWords {
  static constexpr int kRoom = (HeightTile::kRows + 3) / 4 * 4;  // rows are read by fours
  std::uint64_t of[3][kRoom];
};

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
  // All eight rows of the leaf side by side: in a map's rows, then its columns, and in its middle
  // row.
  __m256i bad = load_bits(gaps);
  for (int r = 1; r <= 2 * ns; ++r) bad = _mm256_or_si256(bad, load_bits(broken + r));
  const __m256i middle = load_bits(beside + ns);
  __m256i near = bad;
  for (int d = 1; d <= ns; ++d) {
    const __m256i left = _mm256_or_si256(bad, middle);
    const __m128i count = _mm_cvtsi32_si128(d), less = _mm_cvtsi32_si128(d - 1);
    near = _mm256_or_si256(near, _mm256_sll_epi32(left, count));
    near = _mm256_or_si256(near, _mm256_srl_epi32(bad, count));
    near = _mm256_or_si256(near, _mm256_srl_epi32(middle, less));
  }
  alignas(32) std::uint32_t unsound[kEdge];
  _mm256_store_si256(reinterpret_cast<__m256i*>(unsound), near);
  for (int v = 0; v < kEdge; ++v) tile.sound[v] = static_cast<std::uint8_t>(~unsound[v] >> kMargin);
}

/// Sums over a row of i^a times height, for the eight columns of the leaf.
struct RowMoments {
  alignas(32) std::int32_t of[5][TileWords::kRoom][HeightTile::kEdge];
};

// Eight columns of two rows or four, in 16 bits, and sums of pairs of them: in each quarter, or
// half, of a vector those of one row.
#ifdef __AVX512F__
using RowPairs = __m512i;
constexpr int kMomentRows = 4;
inline RowPairs columns_from(const TileWords& words, int r, int i) {
  const int word = i < 0 ? 0 : 1;
  const __m256i bytes =
      _mm256_shrdv_epi64(load_bits(words.of[word] + r), load_bits(words.of[word + 1] + r),
                         _mm256_set1_epi64x(8 * (i & 7)));
  return _mm512_cvtepi8_epi16(bytes);
}
inline RowPairs sum16(RowPairs a, RowPairs b) { return _mm512_add_epi16(a, b); }
inline RowPairs difference16(RowPairs a, RowPairs b) { return _mm512_sub_epi16(a, b); }
inline RowPairs low_pairs(RowPairs a, RowPairs b) { return _mm512_unpacklo_epi16(a, b); }
inline RowPairs high_pairs(RowPairs a, RowPairs b) { return _mm512_unpackhi_epi16(a, b); }
inline RowPairs both_factors(std::int32_t two) { return _mm512_set1_epi32(two); }
inline RowPairs add_pairs(RowPairs sum, RowPairs pairs, RowPairs factors) {
  return _mm512_dpwssd_epi32(sum, pairs, factors);
}
inline void store_moments(RowPairs low, RowPairs high, std::int32_t (*to)[HeightTile::kEdge]) {
  const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11),
                second = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
  _mm512_storeu_si512(to[0], _mm512_permutex2var_epi64(low, first, high));
  _mm512_storeu_si512(to[2], _mm512_permutex2var_epi64(low, second, high));
}
#else
using RowPairs = __m256i;
constexpr int kMomentRows = 2;
inline RowPairs columns_from(const TileWords& words, int r, int i) {
  const int word = i < 0 ? 0 : 1;
  const auto at = [&](int k) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(words.of[k] + r));
  };
  const __m128i bytes =
      _mm_or_si128(_mm_srl_epi64(at(word), _mm_cvtsi32_si128(8 * (i & 7))),
                   _mm_sll_epi64(at(word + 1), _mm_cvtsi32_si128(64 - 8 * (i & 7))));
  return _mm256_cvtepi8_epi16(bytes);
}
inline RowPairs sum16(RowPairs a, RowPairs b) { return _mm256_add_epi16(a, b); }
inline RowPairs difference16(RowPairs a, RowPairs b) { return _mm256_sub_epi16(a, b); }
inline RowPairs low_pairs(RowPairs a, RowPairs b) { return _mm256_unpacklo_epi16(a, b); }
inline RowPairs high_pairs(RowPairs a, RowPairs b) { return _mm256_unpackhi_epi16(a, b); }
inline RowPairs both_factors(std::int32_t two) { return _mm256_set1_epi32(two); }
inline RowPairs add_pairs(RowPairs sum, RowPairs pairs, RowPairs factors) {
  return _mm256_add_epi32(sum, _mm256_madd_epi16(pairs, factors));
}
inline void store_moments(RowPairs low, RowPairs high, std::int32_t (*to)[HeightTile::kEdge]) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to[0]),
                      _mm256_permute2x128_si256(low, high, 0x20));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to[1]),
                      _mm256_permute2x128_si256(low, high, 0x31));
}
#endif

/// Several rows at a time: the heights i to either side are added, and subtracted, and taken in
/// pairs.
template <int kPairs>
inline void row_moments(const TileWords& words, int ns, RowMoments& moments) {
  std::int16_t factor[5][kPairs][2];
  for (int pair = 0; pair < kPairs; ++pair) {
    for (int half = 0; half < 2; ++half) {
      const int i = 2 * pair + 1 + half;
      int power = i <= ns ? 1 : 0;
      for (int a = 0; a < 5; ++a, power *= i)
        factor[a][pair][half] = static_cast<std::int16_t>(power);
    }
  }
  const auto factors = [&](int a, int pair) {
    std::int32_t two;
    __builtin_memcpy(&two, factor[a][pair], sizeof two);
    return both_factors(two);
  };
  const RowPairs none = both_factors(0);
  for (int r = 0; r < HeightTile::kEdge + 2 * ns; r += kMomentRows) {
    const auto at = [&](int i) { return columns_from(words, r, i); };
    RowPairs low[5], high[5];
    const RowPairs middle = at(0);
    for (int a = 0; a < 5; ++a) low[a] = high[a] = none;
    low[0] = add_pairs(none, low_pairs(middle, none), both_factors(1));
    high[0] = add_pairs(none, high_pairs(middle, none), both_factors(1));
#pragma GCC unroll 4
    for (int pair = 0; pair < kPairs; ++pair) {
      const int i = 2 * pair + 1;
      const RowPairs right0 = at(i), left0 = at(-i), right1 = at(i + 1), left1 = at(-i - 1);
      const RowPairs even0 = sum16(right0, left0), odd0 = difference16(right0, left0);
      const RowPairs even1 = sum16(right1, left1), odd1 = difference16(right1, left1);
      const RowPairs even_low = low_pairs(even0, even1), even_high = high_pairs(even0, even1),
                     odd_low = low_pairs(odd0, odd1), odd_high = high_pairs(odd0, odd1);
#pragma GCC unroll 5
      for (int a = 0; a < 5; ++a) {
        const RowPairs f = factors(a, pair);
        low[a] = add_pairs(low[a], a % 2 == 0 ? even_low : odd_low, f);
        high[a] = add_pairs(high[a], a % 2 == 0 ? even_high : odd_high, f);
      }
    }
    for (int a = 0; a < 5; ++a) store_moments(low[a], high[a], moments.of[a] + r);
  }
}

// Sums of eight columns, of one row of the leaf or of two, four apart.
#ifdef __AVX512F__
using ColumnSums = __m512i;
constexpr int kSumRows = 2;
inline ColumnSums load_sums(const std::int32_t (*rows)[HeightTile::kEdge]) {
  return _mm512_inserti64x4(_mm512_castsi256_si512(load_bits(rows[0])), load_bits(rows[4]), 1);
}
inline void store_sums(ColumnSums v, int f, std::int32_t (*to)[kQuadric][HeightTile::kEdge]) {
  _mm256_store_si256(reinterpret_cast<__m256i*>(to[0][f]), _mm512_castsi512_si256(v));
  _mm256_store_si256(reinterpret_cast<__m256i*>(to[4][f]), _mm512_extracti64x4_epi64(v, 1));
}
inline ColumnSums sums_of(int v) { return _mm512_set1_epi32(v); }
inline ColumnSums plus32(ColumnSums a, ColumnSums b) { return _mm512_add_epi32(a, b); }
inline ColumnSums minus32(ColumnSums a, ColumnSums b) { return _mm512_sub_epi32(a, b); }
inline ColumnSums times32(ColumnSums a, ColumnSums b) { return _mm512_mullo_epi32(a, b); }
#else
using ColumnSums = __m256i;
constexpr int kSumRows = 1;
inline ColumnSums load_sums(const std::int32_t (*rows)[HeightTile::kEdge]) {
  return load_bits(rows[0]);
}
inline void store_sums(ColumnSums v, int f, std::int32_t (*to)[kQuadric][HeightTile::kEdge]) {
  _mm256_store_si256(reinterpret_cast<__m256i*>(to[0][f]), v);
}
inline ColumnSums sums_of(int v) { return _mm256_set1_epi32(v); }
inline ColumnSums plus32(ColumnSums a, ColumnSums b) { return _mm256_add_epi32(a, b); }
inline ColumnSums minus32(ColumnSums a, ColumnSums b) { return _mm256_sub_epi32(a, b); }
inline ColumnSums times32(ColumnSums a, ColumnSums b) { return _mm256_mullo_epi32(a, b); }
#endif

/// The filter's sums of all maps of a tile. The moments i^a j^b of a map follow from those of the
/// map one row before: a row leaves, j becomes j - 1, a row comes.
inline void tile_sums(const RowMoments& rows, HeightTile& tile) {
  const int ns = tile.ns;
  const Taper taper = taper_of(ns);
  const ColumnSums at_centre = sums_of(taper.centre), fall = sums_of(taper.fall);
  ColumnSums m[5][5];
  const auto row = [&](int a, int r) { return load_sums(rows.of[a] + r); };
#pragma GCC unroll 5
  for (int a = 0; a < 5; ++a) {
    for (int b = 0; a + b < 5; ++b) m[a][b] = sums_of(0);
    for (int j = -ns; j <= ns; ++j) {
      ColumnSums part = row(a, ns + j);
      const ColumnSums factor = sums_of(j);
#pragma GCC unroll 5
      for (int b = 0; a + b < 5; ++b) {
        m[a][b] = plus32(m[a][b], part);
        if (a + b < 4) part = times32(part, factor);
      }
    }
  }
  const ColumnSums leaving = sums_of(-ns), coming = sums_of(ns);
  for (int v = 0;; ++v) {
    const auto put = [&](int f, ColumnSums main, ColumnSums ii, ColumnSums jj) {
      store_sums(minus32(times32(at_centre, main), times32(fall, plus32(ii, jj))), f,
                 tile.sums + v);
    };
    put(0, m[0][0], m[2][0], m[0][2]);
    put(1, m[1][0], m[3][0], m[1][2]);
    put(2, m[0][1], m[2][1], m[0][3]);
    put(3, m[2][0], m[4][0], m[2][2]);
    put(4, m[1][1], m[3][1], m[1][3]);
    put(5, m[0][2], m[2][2], m[0][4]);
    if (v == HeightTile::kEdge / kSumRows - 1) break;
#pragma GCC unroll 5
    for (int a = 0; a < 5; ++a) {
      ColumnSums gone = row(a, v), come = row(a, v + 2 * ns + 1);
#pragma GCC unroll 5
      for (int b = 0; a + b < 5; ++b) {
        m[a][b] = minus32(m[a][b], gone);
        if (a + b < 4) gone = times32(gone, leaving);
      }
      // (j - 1)^b of all b from j^b, by differences.
#pragma GCC unroll 4
      for (int pass = 1; pass < 5 - a; ++pass) {
#pragma GCC unroll 4
        for (int b = 4 - a; b >= pass; --b) m[a][b] = minus32(m[a][b], m[a][b - 1]);
      }
#pragma GCC unroll 5
      for (int b = 0; a + b < 5; ++b) {
        m[a][b] = plus32(m[a][b], come);
        if (a + b < 4) come = times32(come, coming);
      }
    }
  }
}

void read_tile(const ColumnBits::Windows& columns, HeightTile& tile) noexcept {
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
  RowMoments rows;
  switch ((tile.ns + 1) / 2) {
    case 1:
      row_moments<1>(words, tile.ns, rows);
      break;
    case 2:
      row_moments<2>(words, tile.ns, rows);
      break;
    case 3:
      row_moments<3>(words, tile.ns, rows);
      break;
    default:
      row_moments<4>(words, tile.ns, rows);
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
