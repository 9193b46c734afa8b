// The loops of map_kernels.hpp in single precision, written once and compiled for each instruction
// set by the files that include this. Eight lanes everywhere: the bits do not depend on the set.

#include "engine/core/lanes.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// Eight heights of a row as they lie.
inline IntLanes heights(const signed char* row) {
#ifdef __AVX2__
  const __m128i eight = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(row));
  return reinterpret_cast<IntLanes>(_mm256_cvtepi8_epi32(eight));
#else
  return IntLanes{row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7]};
#endif
}
/// The surface is half a voxel beyond the centre of the outermost solid voxel.
inline Lanes outward(const IntLanes& heights, int sign) {
  return __builtin_convertvector(heights, Lanes) * static_cast<float>(sign) + 0.5f;
}
constexpr Lanes kAlong = {0, 1, 2, 3, 4, 5, 6, 7};

/// The surfaces of eight fits.
inline ColumnQuadricOf<Lanes> quadrics_of(const SurfaceGroup& g, int stride) {
  std::array<IntLanes, kQuadric> sums;
  for (unsigned f = 0; f < kQuadric; ++f) sums[f] = load(g.sums[f]);
  const FilterSolutionOf<IntLanes, Lanes> solution{
      load(g.weights[0]),  load(g.weights[1]),  load(g.solution[0]), load(g.solution[1]),
      load(g.solution[2]), load(g.solution[3]), load(g.solution[4]), load(g.solution[5])};
  const QuadricOf<Lanes> fitted =
      quadric_of(sums, load(g.centre), load(g.level), load(g.sign), solution,
                 [](const IntLanes& v) { return __builtin_convertvector(v, Lanes); });
  const FilterAnswersOf<Lanes> answers{load(g.answers[0]), load(g.answers[1]), load(g.answers[2]),
                                       load(g.answers[3]), load(g.answers[4]), load(g.answers[5]),
                                       load(g.answers[6]), load(g.answers[7])};
  return column_quadric(fitted, answers, static_cast<float>(stride));
}

inline FootOf<Lanes> store_feet(const ColumnQuadricOf<Lanes>& q, SurfaceGroup& g) {
  const FootOf<Lanes> foot = foot_of(q, square_root);
  store(foot.normal_x, g.normal_x), store(foot.normal_y, g.normal_y);
  store(foot.normal_z, g.normal_z), store(foot.offset, g.offset);
  return foot;
}

inline void feet_of(SurfaceGroup* groups, std::size_t count) noexcept {
  for (SurfaceGroup* g = groups; g != groups + count; ++g) {
    const FootOf<Lanes> foot = store_feet(quadrics_of(*g, 1), *g);
    // Map space to index space (to_index_space), by lane.
    const Lanes u = foot.normal_x, v = foot.normal_y, w = load(g->sign) * foot.normal_z;
    const IntLanes axis = load(g->axis), along_x = axis == 0, along_y = axis == 1;
    const Lanes x = along_x ? w : along_y ? v : u;
    const Lanes y = along_x ? u : along_y ? w : v;
    const Lanes z = along_x ? v : along_y ? u : w;
    store(x, g->index_normal[0]), store(y, g->index_normal[1]), store(z, g->index_normal[2]);
    const Lanes cosine = x * load(g->coarse[0]) + (y * load(g->coarse[1]) + z * load(g->coarse[2]));
    store(cosine > 0.0f, g->agrees);
  }
}

inline void surfaces_of(SurfaceGroup& g, int stride) noexcept {
  const ColumnQuadricOf<Lanes> q = quadrics_of(g, stride);
  for (unsigned f = 0; f < kQuadric; ++f) store(q.c[f], g.c[f]);
  store(q.t_x, g.t_x), store(q.t_y, g.t_y), store(q.quartic, g.quartic);
  store_feet(q, g);
}

inline float largest_residual(const HeightMap& map, const ColumnQuadric& surface) noexcept {
  // Of the heights as they are stored: the surface is turned inward instead, once.
  const auto sign = static_cast<float>(map.sign), stride = static_cast<float>(map.stride);
  const float c0 = (surface.c[0] - 0.5f) * sign, c1 = surface.c[1] * sign * stride,
              c2 = surface.c[2] * sign * stride;
  const float area = sign * stride * stride;
  const float c3 = surface.c[3] * area, c4 = surface.c[4] * area, c5 = surface.c[5] * area;
  const float tx = surface.t_x * stride, ty = surface.t_y * stride;
  const int middle = map.lanes / 2, first = (middle - map.ns) / 8, end = (middle + map.ns) / 8 + 1;
  Lanes largest{};
  for (int group = first; group < end; ++group) {
    const Lanes i = kAlong + static_cast<float>(8 * group - middle);
    const Lanes z1_i = c0 + c1 * i, z2_i = c3 * i * i, twist = c4 * i, t_i = 1.0f + tx * i;
    const signed char* row = map.height.data() + 8 * group;
    Lanes most{};
    for (int j = -map.ns; j <= map.ns; ++j, row += map.lanes) {
      const auto y = static_cast<float>(j);
      const Lanes z2 = z2_i + twist * y + c5 * y * y;
      const Lanes z = z1_i + c2 * y + z2 * (t_i + ty * y);
      const Lanes residual = abs(__builtin_convertvector(heights(row), Lanes) - z);
      most = larger(most, residual);
    }
    most = abs(i) <= static_cast<float>(map.ns) ? most : Lanes{};
    largest = larger(largest, most);
  }
  return largest_of(largest);
}

// --- Half-discs. Rows of sixteen lanes, i = -8 to 7, whatever the map's.
// --------------------------

struct DiscMasks {
  static constexpr int kRows = 2 * kDiscReach + 1;
  alignas(32) int half[kHalves][kRows][2][8];  // -1: in it
};
constexpr DiscMasks make_disc_masks() {
  DiscMasks masks{};
  constexpr int kRays[kHalves][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                     {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  for (int d = 0; d < kHalves; ++d) {
    for (int row = 0; row < DiscMasks::kRows; ++row) {
      for (int lane = 0; lane < 16; ++lane) {
        const int i = lane - 8, j = row - kDiscReach;
        const bool in_disc = 100 * (i * i + j * j) <= 68 * 68;
        const bool in_half = i * kRays[d][0] + j * kRays[d][1] >= 0;
        masks.half[d][row][lane / 8][lane % 8] = in_disc && in_half ? -1 : 0;
      }
    }
  }
  return masks;
}
constexpr DiscMasks kDiscMasks = make_disc_masks();

/// Calls `each(found, x, y, twice z, row, group)` for eight pixels of the disc's rows after the
/// other.
template <class Each>
inline void for_disc(const HeightMap& map, const Each& each) {
  const int reach = map.ns < kDiscReach ? map.ns : kDiscReach;
  const auto twice_sign = static_cast<float>(2 * map.sign);
  for (int group = 0; group < 2; ++group) {
    const Lanes x = kAlong + static_cast<float>(8 * group - 8);
    const signed char* row =
        map.height.data() + (map.ns - reach) * map.lanes + map.lanes / 2 - 8 + 8 * group;
    for (int j = -reach; j <= reach; ++j, row += map.lanes) {
      const IntLanes height = heights(row);
      each(height != int{HeightMap::kNone}, x, static_cast<float>(j),
           __builtin_convertvector(height, Lanes) * twice_sign + 1.0f, j + kDiscReach, group);
    }
  }
}

struct LaneSums9 {
  Lanes n{}, i{}, j{}, ii{}, ij{}, jj{}, z{}, iz{}, jz{};

  void add(const IntLanes& mask, const Lanes& x, float y, const Lanes& z2) {
    const Lanes one = where(mask, Lanes{} + 1.0f), mi = where(mask, x), mz = where(mask, z2);
    const Lanes mj = one * y;
    n += one, i += mi, j += mj, ii += mi * x, ij += mi * y, jj += mj * y;
    z += mz, iz += mz * x, jz += mz * y;
  }
  PlaneSums total() const {
    return {sum_of(n),  sum_of(i), sum_of(j),  sum_of(ii), sum_of(ij),
            sum_of(jj), sum_of(z), sum_of(iz), sum_of(jz)};
  }
};

inline void half_sums(const HeightMap& map, std::array<PlaneSums, kHalves>& sums) noexcept {
  for (unsigned d = 0; d < kHalves; ++d) {
    LaneSums9 s;
    for_disc(map,
             [&](const IntLanes& found, const Lanes& x, float y, const Lanes& z2, int row,
                 int group) { s.add(found & load(kDiscMasks.half[d][row][group]), x, y, z2); });
    sums[d] = s.total();
  }
}

inline Lanes residual_across(const HeightPlane& plane, const Lanes& x, float y, const Lanes& z2) {
  return (z2 * 0.5f - (plane.c0 + plane.c2 * y) - plane.c1 * x) * plane.cosine;
}

inline void sums_on_plane(const HeightMap& map, int half, const HeightPlane& plane,
                          PlaneSums& sums) noexcept {
  LaneSums9 s;
  for_disc(map, [&](const IntLanes& found, const Lanes& x, float y, const Lanes& z2, int row,
                    int group) {
    const IntLanes on = abs(residual_across(plane, x, y, z2)) <= plane.slack;
    s.add(found & on & load(kDiscMasks.half[half][row][group]), x, y, z2);
  });
  sums = s.total();
}

inline void residuals_on_plane(const HeightMap& map, int half, const HeightPlane& first,
                               const HeightPlane& plane, Residuals& residuals) noexcept {
  Lanes largest{}, squares{};
  for_disc(map, [&](const IntLanes& found, const Lanes& x, float y, const Lanes& z2, int row,
                    int group) {
    const IntLanes on = abs(residual_across(first, x, y, z2)) <= first.slack;
    const Lanes r = where(found & on & load(kDiscMasks.half[half][row][group]),
                          residual_across(plane, x, y, z2));
    largest = larger(largest, abs(r));
    squares += r * r;
  });
  residuals.largest = largest_of(largest);
  residuals.sum_squares = sum_of(squares);
}

// --- Points in a ball ---------------------------------------------------------------------------

inline void gather_points(const HeightMap& map, const TiltedFrame& frame,
                          TiltedPoints& points) noexcept {
  const float radius = frame.radius, unit = 1.0f / radius;
  const int reach = radius < static_cast<float>(map.ns) ? static_cast<int>(radius) : map.ns;
  const int middle = map.lanes / 2, first = (middle - reach) / 8, end = (middle + reach) / 8 + 1;
  const float limit = radius * radius, fall = 1.0f / (1.05f * limit);
  // By value: what is stored below could be what a reference refers to.
  const auto [u0, u1, u2] = frame.u;
  const auto [w0, w1, w2] = frame.w;
  const auto [n0, n1, n2] = frame.n;
  const int sign = map.sign, lanes = map.lanes;
  IntLanes count{};
  TiltedPoints::Group* g = points.group.data();
  for (int group = first; group < end; ++group) {
    const Lanes x = kAlong + static_cast<float>(8 * group - middle);
    const Lanes xx = x * x, x_u = x * (u0 * unit), x_w = x * (w0 * unit), x_n = x * (n0 * unit);
    const signed char* row = map.height.data() + (map.ns - reach) * lanes + 8 * group;
    for (int j = -reach; j <= reach; ++j, row += lanes, ++g) {
      const float y = static_cast<float>(j), y_unit = y * unit;
      const IntLanes height = heights(row);
      const Lanes z = outward(height, sign), z_unit = z * unit;
      const Lanes r2 = xx + y * y + z * z;
      // kNone is far out of every ball.
      const IntLanes in_ball = r2 <= limit;
      count -= in_ball;
      store(in_ball ? 1.0f - r2 * fall : Lanes{}, g->weight);
      store(x_u + y_unit * u1 + z_unit * u2, g->u);
      store(x_w + y_unit * w1 + z_unit * w2, g->w);
      store(x_n + y_unit * n1 + z_unit * n2, g->n);
    }
  }
  const int groups = static_cast<int>(g - points.group.data());
  points.groups = groups;
  points.count = 0;
  for (int lane = 0; lane < 8; ++lane) points.count += count[lane];
}

// Two passes: the sums of one take all the registers there are.
inline void tilted_moments(const TiltedPoints& points, TiltedMoments& moments) noexcept {
  const TiltedPoints::Group* const begin = points.group.data();
  const TiltedPoints::Group* const end = begin + points.groups;
  {
    Lanes m00{}, m01{}, m02{}, m10{}, m11{}, m20{}, z00{}, z01{}, z02{}, z10{}, z11{}, z20{};
    for (const TiltedPoints::Group* g = begin; g != end; ++g) {
      const Lanes weight = load(g->weight), u = load(g->u), w = load(g->w), n = load(g->n);
      const Lanes w1 = weight * w, u1 = weight * u, w2 = w1 * w, uw = u1 * w, u2 = u1 * u;
      m00 += weight, m01 += w1, m02 += w2, m10 += u1, m11 += uw, m20 += u2;
      z00 += weight * n, z01 += w1 * n, z02 += w2 * n;
      z10 += u1 * n, z11 += uw * n, z20 += u2 * n;
    }
    auto& m = moments.m;
    m[0][0] = sum_of(m00), m[0][1] = sum_of(m01), m[0][2] = sum_of(m02);
    m[1][0] = sum_of(m10), m[1][1] = sum_of(m11), m[2][0] = sum_of(m20);
    auto& z = moments.z;
    z[0][0] = sum_of(z00), z[0][1] = sum_of(z01), z[0][2] = sum_of(z02);
    z[1][0] = sum_of(z10), z[1][1] = sum_of(z11), z[2][0] = sum_of(z20);
  }
  Lanes m03{}, m04{}, m12{}, m13{}, m21{}, m22{}, m30{}, m31{}, m40{};
  for (const TiltedPoints::Group* g = begin; g != end; ++g) {
    const Lanes weight = load(g->weight), u = load(g->u), w = load(g->w);
    const Lanes w2 = weight * w * w, w3 = w2 * w, uw2 = w2 * u;
    const Lanes u2 = weight * u * u, u3 = u2 * u, u2w = u2 * w;
    m03 += w3, m04 += w3 * w, m12 += uw2, m13 += uw2 * w;
    m21 += u2w, m22 += u2w * w, m30 += u3, m31 += u3 * w, m40 += u3 * u;
  }
  auto& m = moments.m;
  m[0][3] = sum_of(m03), m[0][4] = sum_of(m04), m[1][2] = sum_of(m12), m[1][3] = sum_of(m13);
  m[2][1] = sum_of(m21), m[2][2] = sum_of(m22);
  m[3][0] = sum_of(m30), m[3][1] = sum_of(m31), m[4][0] = sum_of(m40);
}

inline void tilted_residuals(const TiltedPoints& points, const Quadric& c,
                             Residuals& residuals) noexcept {
  Lanes largest{}, squares{};
  for (int k = 0; k < points.groups; ++k) {
    const TiltedPoints::Group& g = points.group[static_cast<unsigned>(k)];
    const Lanes u = load(g.u), w = load(g.w);
    const Lanes fitted = c[0] + (c[1] + c[3] * u + c[4] * w) * u + (c[2] + c[5] * w) * w;
    const Lanes r = load(g.weight) > 0.0f ? load(g.n) - fitted : Lanes{};
    const Lanes size = abs(r);
    largest = larger(largest, size);
    squares += r * r;
  }
  residuals.largest = largest_of(largest);
  residuals.sum_squares = sum_of(squares);
}

}  // namespace

}  // namespace sulcus
