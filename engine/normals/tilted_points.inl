// The loops of map_kernels.hpp in single precision, written once and compiled for each instruction
// set by the files that include this. Eight lanes everywhere: the bits do not depend on the set.

#pragma once

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

inline FilterSolutionOf<IntLanes, Lanes> solutions_of(const SurfaceGroup& g) {
  return {load(g.weights[0]),  load(g.weights[1]),  load(g.solution[0]), load(g.solution[1]),
          load(g.solution[2]), load(g.solution[3]), load(g.solution[4]), load(g.solution[5])};
}

/// The surfaces of eight fits.
inline ColumnQuadricOf<Lanes> quadrics_of(const SurfaceGroup& g, int stride) {
  std::array<IntLanes, kQuadric> sums;
  for (unsigned f = 0; f < kQuadric; ++f) sums[f] = load(g.sums[f]);
  const QuadricOf<Lanes> fitted =
      quadric_of(sums, load(g.centre), load(g.level), load(g.sign), solutions_of(g), to_float);
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

inline void store_surfaces(const ColumnQuadricOf<Lanes>& q, SurfaceGroup& g) {
  for (unsigned f = 0; f < kQuadric; ++f) store(q.c[f], g.c[f]);
  store(q.t_x, g.t_x), store(q.t_y, g.t_y), store(q.quartic, g.quartic);
  store_feet(q, g);
}

inline void surfaces_of(SurfaceGroup& g, int stride) noexcept {
  store_surfaces(quadrics_of(g, stride), g);
}

inline void sharpen_group(SurfaceGroup& g) noexcept {
  ColumnQuadricOf<Lanes> q;
  ResidualCubesOf<Lanes> cubes;
  for (unsigned f = 0; f < kQuadric; ++f) q.c[f] = load(g.c[f]), cubes[f] = load(g.cubes[f]);
  sharpen(solutions_of(g), cubes, 1.0f, q);
  store_surfaces(q, g);
}

inline float map_residuals(const HeightMap& map, const ColumnQuadric& surface,
                           ResidualCubes& cubes) noexcept {
  // Of the heights as they are stored: the surface is turned inward instead, once.
  const auto sign = static_cast<float>(map.sign), stride = static_cast<float>(map.stride);
  const float c0 = (surface.c[0] - 0.5f) * sign, c1 = surface.c[1] * sign * stride,
              c2 = surface.c[2] * sign * stride;
  const float area = sign * stride * stride;
  const float c3 = surface.c[3] * area, c4 = surface.c[4] * area, c5 = surface.c[5] * area;
  const float tx = surface.t_x * stride, ty = surface.t_y * stride, cubic = c5 * ty;
  const Taper taper = taper_of(map.ns);
  const auto centre = static_cast<float>(taper.centre), fall = static_cast<float>(taper.fall);
  const int middle = map.lanes / 2, first = (middle - map.ns) / 8, end = (middle + map.ns) / 8 + 1;
  Lanes largest{}, one{}, i{}, j{}, ii{}, ij{}, jj{};
  for (int group = first; group < end; ++group) {
    const Lanes x = kAlong + static_cast<float>(8 * group - middle);
    const IntLanes inside = abs(x) <= static_cast<float>(map.ns);
    // By powers of y.
    const Lanes z2 = c3 * x * x, twist = c4 * x, t = 1.0f + tx * x;
    const Lanes a0 = c0 + c1 * x + z2 * t, a1 = c2 + twist * t + z2 * ty, a2 = c5 * t + twist * ty;
    const Lanes weight_x = centre - fall * x * x;
    Lanes most{}, cube0{}, cube1{}, cube2{};
    const auto take = [&](const Lanes& r, const Lanes& weight) {
      most = larger(most, abs(r));
      return weight * r * (r * r);
    };
    const signed char* const row = map.height.data() + map.ns * map.lanes + 8 * group;
    cube0 = take(to_float(heights(row)) - a0, weight_x);
    // Rows +j and -j together: what is even in y, and what is odd.
    Lanes y{};
    for (int v = 1; v <= map.ns; ++v) {
      y += 1.0f;
      const Lanes yy = y * y;
      const Lanes even = a2 * yy + a0, odd = (a1 + cubic * yy) * y;
      const Lanes weight = weight_x - fall * yy;
      const Lanes above = take(to_float(heights(row + v * map.lanes)) - (even + odd), weight);
      const Lanes below = take(to_float(heights(row - v * map.lanes)) - (even - odd), weight);
      const Lanes both = above + below;
      cube0 += both, cube1 += (above - below) * y, cube2 += both * yy;
    }
    cube0 = where(inside, cube0), cube1 = where(inside, cube1), cube2 = where(inside, cube2);
    largest = larger(largest, where(inside, most));
    one += cube0, i += cube0 * x, ii += cube0 * x * x;
    j += cube1, ij += cube1 * x, jj += cube2;
  }
  cubes = {sign * sum_of(one), sign * sum_of(i),  sign * sum_of(j),
           sign * sum_of(ii),  sign * sum_of(ij), sign * sum_of(jj)};
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

inline void close_sums(const HeightMap& map, PlaneSums& sums) noexcept {
  constexpr int kReach = 3;
  constexpr float kReach4 = 51.0f;  // 4 * 3.6^2
  const int reach = map.ns < kReach ? map.ns : kReach;
  const auto twice_sign = static_cast<float>(2 * map.sign);
  const Lanes x = kAlong - static_cast<float>(kReach);
  const Lanes four_xx = 4.0f * x * x;
  const signed char* row =
      map.height.data() + (map.ns - reach) * map.lanes + map.lanes / 2 - kReach;
  LaneSums9 s;
  for (int j = -reach; j <= reach; ++j, row += map.lanes) {
    const auto y = static_cast<float>(j);
    const Lanes z2 = __builtin_convertvector(heights(row), Lanes) * twice_sign + 1.0f;
    // kNone is far out of it.
    s.add(four_xx + 4.0f * y * y + z2 * z2 <= kReach4, x, y, z2);
  }
  sums = s.total();
}

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

/// Appends the lanes in a mask; beyond them seven floats more may be written.
class PointWriter {
 public:
  explicit PointWriter(TiltedPoints& points) : points_(points) {}

  void append(const IntLanes& mask, const Lanes& weight, const Lanes& u, const Lanes& w,
              const Lanes& n) {
#ifdef __AVX2__
    const unsigned bits = bits_of(mask);
    const __m256i from = to_front(bits);
    const auto put = [&](const Lanes& v, float* to) {
      store(_mm256_permutevar8x32_ps(v, from), to + count_);
    };
    put(weight, points_.weight), put(u, points_.u), put(w, points_.w), put(n, points_.n);
    count_ += __builtin_popcount(bits);
#else
    for (int lane = 0; lane < 8; ++lane) {
      if (mask[lane] == 0) continue;
      points_.weight[count_] = weight[lane], points_.u[count_] = u[lane];
      points_.w[count_] = w[lane], points_.n[count_] = n[lane];
      ++count_;
    }
#endif
  }
  void finish() {
    store(Lanes{}, points_.weight + count_), store(Lanes{}, points_.u + count_);
    store(Lanes{}, points_.w + count_), store(Lanes{}, points_.n + count_);
    points_.count = count_;
  }

 private:
  TiltedPoints& points_;
  int count_ = 0;
};

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
  PointWriter writer(points);
  for (int group = first; group < end; ++group) {
    const Lanes x = kAlong + static_cast<float>(8 * group - middle);
    const Lanes xx = x * x, x_u = x * (u0 * unit), x_w = x * (w0 * unit), x_n = x * (n0 * unit);
    const signed char* row = map.height.data() + (map.ns - reach) * lanes + 8 * group;
    for (int j = -reach; j <= reach; ++j, row += lanes) {
      const float y = static_cast<float>(j), y_unit = y * unit;
      const Lanes z = outward(heights(row), sign), z_unit = z * unit;
      const Lanes r2 = xx + y * y + z * z;
      // kNone is far out of every ball.
      writer.append(r2 <= limit, 1.0f - r2 * fall, x_u + y_unit * u1 + z_unit * u2,
                    x_w + y_unit * w1 + z_unit * w2, x_n + y_unit * n1 + z_unit * n2);
    }
  }
  writer.finish();
}

// Two passes: the sums of one take all the registers there are.
inline void tilted_moments(const TiltedPoints& points, TiltedMoments& moments) noexcept {
  const TiltedPoints& p = points;
  {
    Lanes m00{}, m01{}, m02{}, m10{}, m11{}, m20{}, z00{}, z01{}, z02{}, z10{}, z11{}, z20{};
    for (int k = 0; k < p.count; k += 8) {
      const Lanes weight = load(p.weight + k), u = load(p.u + k), w = load(p.w + k),
                  n = load(p.n + k);
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
  for (int k = 0; k < p.count; k += 8) {
    const Lanes weight = load(p.weight + k), u = load(p.u + k), w = load(p.w + k);
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

inline Lanes residual_of(const TiltedPoints& p, int k, const Quadric& c) {
  const Lanes u = load(p.u + k), w = load(p.w + k);
  return load(p.n + k) - (c[0] + (c[1] + c[3] * u + c[4] * w) * u + (c[2] + c[5] * w) * w);
}

inline void tilted_residuals(const TiltedPoints& points, const Quadric& c,
                             Residuals& residuals) noexcept {
  Lanes largest{}, squares{};
  for (int k = 0; k < points.count; k += 8) {
    const Lanes residual = residual_of(points, k, c);
    const Lanes r = load(points.weight + k) > 0.0f ? residual : Lanes{};
    largest = larger(largest, abs(r));
    squares += r * r;
  }
  residuals.largest = largest_of(largest);
  residuals.sum_squares = sum_of(squares);
}

inline void sharpen_points(const Quadric& c, TiltedPoints& points) noexcept {
  for (int k = 0; k < points.count; k += 8) {
    const Lanes r = residual_of(points, k, c);
    store(load(points.weight + k) * r * r, points.weight + k);
    store(r, points.n + k);
  }
}

}  // namespace

}  // namespace sulcus
