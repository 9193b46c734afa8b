// Tiles of a leaf for AVX2: a part of map_kernels_avx2.cpp, whose helpers it uses.

namespace sulcus {

namespace {

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

}  // namespace

}  // namespace sulcus
