// The loops of map_kernels.hpp in single precision, written once and compiled for each instruction
// set by the files that include this; the bits do not depend on the set (row_lanes.inl).

#pragma once

#include "engine/normals/map_kernels.hpp"
#include "engine/normals/row_lanes.inl"

namespace sulcus {

namespace {

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

using Lanes3 = std::array<Lanes, 3>;

inline Lanes3 load3(const float (&v)[3][SurfaceGroup::kSize]) {
  return {load(v[0]), load(v[1]), load(v[2])};
}
inline Lanes dot(const Lanes3& a, const Lanes3& b) {
  return a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]);
}

/// The normals in index space (to_index_space), by lane.
inline Lanes3 store_normals(const FootOf<Lanes>& foot, SurfaceGroup& g) {
  const Lanes u = foot.normal_x, v = foot.normal_y, w = load(g.sign) * foot.normal_z;
  const IntLanes axis = load(g.axis), along_x = axis == 0, along_y = axis == 1;
  const Lanes3 normal{along_x   ? w
                      : along_y ? v
                                : u,
                      along_x   ? u
                      : along_y ? w
                                : v,
                      along_x   ? v
                      : along_y ? u
                                : w};
  for (unsigned a = 0; a < 3; ++a) store(normal[a], g.index_normal[a]);
  return normal;
}

/// What the tool has to say of each (heard).
inline Lanes3 tools_heard(const Lanes3& coarse, const SurfaceGroup& g) {
  Lanes3 tool = load3(g.tool);
  const Lanes along = dot(coarse, tool);
  const IntLanes far_side =
      (along < 0.0f) & (along * along > 0.25f * dot(coarse, coarse) * dot(tool, tool));
  for (Lanes& component : tool) component = where(~far_side, component);
  return tool;
}

/// Which normals stand.
inline void store_standing(const Lanes3& normal, SurfaceGroup& g) {
  const Lanes3 coarse = load3(g.coarse);
  const Lanes tool = dot(normal, tools_heard(coarse, g));
  store((dot(normal, coarse) > 0.0f) & ~(tool < 0.0f), g.stands);
}

inline void feet_of(SurfaceGroup* groups, std::size_t count) noexcept {
  for (SurfaceGroup* g = groups; g != groups + count; ++g) {
    store_standing(store_normals(store_feet(quadrics_of(*g, 1), *g), *g), *g);
  }
}

inline FootOf<Lanes> store_surfaces(const ColumnQuadricOf<Lanes>& q, SurfaceGroup& g) {
  for (unsigned f = 0; f < kQuadric; ++f) store(q.c[f], g.c[f]);
  store(q.t_x, g.t_x), store(q.t_y, g.t_y), store(q.quartic, g.quartic);
  return store_feet(q, g);
}

inline void surfaces_of(SurfaceGroup& g, int stride) noexcept {
  store_surfaces(quadrics_of(g, stride), g);
}

inline void sharpen_group(SurfaceGroup& g) noexcept {
  ColumnQuadricOf<Lanes> q;
  ResidualCubesOf<Lanes> cubes;
  for (unsigned f = 0; f < kQuadric; ++f) q.c[f] = load(g.c[f]), cubes[f] = load(g.cubes[f]);
  sharpen(solutions_of(g), cubes, 1.0f, q);
  store_standing(store_normals(store_surfaces(q, g), g), g);
  store((abs(q.c[3]) + abs(q.c[4]) + abs(q.c[5])) * load(g.normal_z), g.bend);
}

/// The filters' weights, centre - fall (i^2 + j^2), of all rings of a map: of row +j or -j, by
/// lane, the middle one at kMaxLanes / 2; zero beyond the map.
struct TaperTable {
  alignas(64) float weight[kMaxNeighbourhood + 1][kMaxNeighbourhood + 1][HeightMap::kMaxLanes];
};
constexpr TaperTable make_tapers() {
  TaperTable table{};
  for (int ns = 1; ns <= kMaxNeighbourhood; ++ns) {
    for (int j = 0; j <= ns; ++j) {
      for (int i = -ns; i <= ns; ++i) {
        table.weight[ns][j][HeightMap::kMaxLanes / 2 + i] =
            static_cast<float>(taper_of(ns).centre - taper_of(ns).fall * (i * i + j * j));
      }
    }
  }
  return table;
}
constexpr TaperTable kTapers = make_tapers();

/// y and its square, of the rows.
struct RowPowers {
  float y[kMaxNeighbourhood + 1], square[kMaxNeighbourhood + 1];
};
constexpr RowPowers make_row_powers() {
  RowPowers powers{};
  for (int v = 0; v <= kMaxNeighbourhood; ++v) {
    powers.y[v] = static_cast<float>(v);
    powers.square[v] = static_cast<float>(v * v);
  }
  return powers;
}
constexpr RowPowers kRowPowers = make_row_powers();

/// A surface turned inward and told in columns, as stored heights are compared with it: the
/// coefficients, and those of x, y and y^3 beyond second order.
template <class Number>
struct InwardOf {
  Number c[kQuadric], tx, ty, cubic;
};
template <class Number>
inline InwardOf<Number> inward(const ColumnQuadricOf<Number>& surface, const Number& sign,
                               float stride) {
  const Number per_column = sign * stride, area = per_column * stride;
  const auto& c = surface.c;
  const Number ty = surface.t_y * stride, c5 = c[5] * area;
  return {
      {(c[0] - 0.5f) * sign, c[1] * per_column, c[2] * per_column, c[3] * area, c[4] * area, c5},
      surface.t_x * stride,
      ty,
      c5 * ty};
}

/// Of the cubes, in eight lanes each; and of the largest squares.
struct ResidualSums {
  std::array<Lanes, kQuadric> of;
  Lanes largest2;
};

/// `kNarrow`: the map has rows of sixteen lanes.
template <bool kNarrow>
[[gnu::always_inline]] inline ResidualSums residual_sums(const MapRows& map, int ns,
                                                         const InwardOf<float>& s) {
  const int middle = kNarrow ? 8 : HeightMap::kMaxLanes / 2;
  const int first = kNarrow ? 0 : (middle - ns) & -kRowStep;
  const int end = kNarrow ? 2 * middle : middle + ns + 1;
  ResidualSums sums{};
  for (int at = first; at < end; at += kRowStep) {
    const RowLanes x = kAlong + static_cast<float>(at - middle);
    // By powers of y.
    const RowLanes z2 = s.c[3] * x * x, twist = s.c[4] * x, t = 1.0f + s.tx * x;
    const RowLanes a0 = s.c[0] + s.c[1] * x + z2 * t, a1 = s.c[2] + twist * t + z2 * s.ty,
                   a2 = s.c[5] * t + twist * s.ty;
    const signed char* const row = map.middle + at;
    const auto* weights = &kTapers.weight[ns][0][HeightMap::kMaxLanes / 2 - middle + at];
    RowLanes most2{};
    const auto cube_at = [&](const signed char* heights_at, const RowLanes& surface_at) {
      const RowLanes r = heights_above(heights_at, map.level) - surface_at, r2 = r * r;
      most2 = larger(most2, r2);
      return r2 * r;
    };
    RowLanes cube0 = load_row(weights) * cube_at(row, a0), cube1{}, cube2{};
    // Rows +j and -j together: what is even in y, and what is odd.
    for (int v = 1; v <= ns; ++v) {
      const RowLanes y = RowLanes{} + kRowPowers.y[v], yy = RowLanes{} + kRowPowers.square[v];
      const RowLanes even = a2 * yy + a0, odd = (a1 + s.cubic * yy) * y;
      const RowLanes above = cube_at(row + v * map.pitch, even + odd);
      const RowLanes below = cube_at(row - v * map.pitch, even - odd);
      const RowLanes weight = load_row(weights + v * HeightMap::kMaxLanes);
      const RowLanes sum = weight * (above + below), difference = weight * (above - below);
      cube0 += sum, cube1 += difference * y, cube2 += sum * yy;
    }
    const auto add = [&](int f, const RowLanes& v) {
      if (at == first) {
        sums.of[f] = halves_of(v);
      } else {
        add_row(sums.of[f], v);
      }
    };
    add(0, cube0), add(1, cube0 * x), add(2, cube1);
    add(3, cube0 * x * x), add(4, cube1 * x), add(5, cube2);
    take_larger(sums.largest2, where(at_most(abs(x), static_cast<float>(ns)), most2));
  }
  return sums;
}

inline float map_residuals(const MapRows& map, const ColumnQuadric& surface,
                           ResidualCubes& cubes) noexcept {
  const auto sign = static_cast<float>(map.sign);
  const InwardOf<float> s = inward(surface, sign, static_cast<float>(map.stride));
  const ResidualSums sums =
      map.lanes == 16 ? residual_sums<true>(map, map.ns, s) : residual_sums<false>(map, map.ns, s);
  cubes = sum_all(sums.of);
  for (float& cube : cubes) cube *= sign;
  return largest_of(sums.largest2);
}

template <bool kNarrow>
inline void group_residuals(const MapRows* maps, int ns, unsigned which, SurfaceGroup& g) {
  constexpr unsigned kSize = SurfaceGroup::kSize;
  ColumnQuadricOf<Lanes> q;
  for (unsigned f = 0; f < kQuadric; ++f) q.c[f] = load(g.c[f]);
  q.t_x = load(g.t_x), q.t_y = load(g.t_y);
  const InwardOf<Lanes> all = inward(q, load(g.sign), 1.0f);
  alignas(32) float c[kQuadric][kSize], tx[kSize], ty[kSize], cubic[kSize];
  for (unsigned f = 0; f < kQuadric; ++f) store(all.c[f], c[f]);
  store(all.tx, tx), store(all.ty, ty), store(all.cubic, cubic);
  Lanes of[kQuadric][kSize], largest2[kSize];
  for (unsigned k = 0; k < kSize; ++k) {
    ResidualSums sums{};
    if ((which >> k & 1u) != 0) {
      sums = residual_sums<kNarrow>(
          maps[k], ns,
          {{c[0][k], c[1][k], c[2][k], c[3][k], c[4][k], c[5][k]}, tx[k], ty[k], cubic[k]});
    }
    for (unsigned f = 0; f < kQuadric; ++f) of[f][k] = sums.of[f];
    largest2[k] = sums.largest2;
  }
  for (unsigned f = 0; f < kQuadric; ++f) store(load(g.sign) * sum_each(of[f]), g.cubes[f]);
  store(largest_each(largest2), g.largest2);
}

inline void group_residuals(const MapRows* maps, unsigned which, SurfaceGroup& g) noexcept {
  if (which == 0) return;
  const MapRows& first = maps[__builtin_ctz(which)];
  first.lanes == 16 ? group_residuals<true>(maps, first.ns, which, g)
                    : group_residuals<false>(maps, first.ns, which, g);
}

// --- Half-discs. Rows of sixteen lanes, i = -8 to 7, whatever the map's. ------------------------

struct DiscMasks {
  static constexpr int kRows = 2 * kDiscReach + 1;
  alignas(32) int half[kHalves][kRows][16];  // -1: in it
  std::uint16_t bits[kHalves][kRows];
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
        if (!in_disc || !in_half) continue;
        masks.half[d][row][lane] = -1;
        masks.bits[d][row] = static_cast<std::uint16_t>(masks.bits[d][row] | 1 << lane);
      }
    }
  }
  return masks;
}
constexpr DiscMasks kDiscMasks = make_disc_masks();

inline RowMask in_half(int half, int row, [[maybe_unused]] int lane) {
#ifdef __AVX512F__
  return kDiscMasks.bits[half][row];
#else
  return load(kDiscMasks.half[half][row] + lane);
#endif
}

/// Calls `each(found, x, y, twice z, row, lane)` for the pixels of the disc's rows, from a lane on,
/// one row after the other.
template <class Each>
inline void for_disc(const HeightMap& map, int lane, const Each& each) {
  const int reach = map.ns < kDiscReach ? map.ns : kDiscReach;
  const auto twice_sign = static_cast<float>(2 * map.sign);
  const RowLanes x = kAlong + static_cast<float>(lane - 8);
  const signed char* row =
      map.height.data() + (map.ns - reach) * map.lanes + map.lanes / 2 - 8 + lane;
  for (int j = -reach; j <= reach; ++j, row += map.lanes) {
    const RowLanes height = heights(row);
    each(above(height, static_cast<float>(HeightMap::kNone)), x, static_cast<float>(j),
         height * twice_sign + 1.0f, j + kDiscReach);
  }
}

/// Of nine sums in the order of PlaneSums.
inline PlaneSums plane_sums(const std::array<Lanes, 9>& nine) {
  const std::array<float, 9> s = sum_all(nine);
  return {s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8]};
}

/// Whole numbers: exact in any order.
struct LaneSums9 {
  RowLanes n{}, i{}, j{}, ii{}, ij{}, jj{}, z{}, iz{}, jz{};

  void add(const RowMask& mask, const RowLanes& x, float y, const RowLanes& z2) {
    const RowLanes one = where(mask, RowLanes{} + 1.0f), mi = where(mask, x), mz = where(mask, z2);
    const RowLanes mj = one * y;
    n += one, i += mi, j += mj, ii += mi * x, ij += mi * y, jj += mj * y;
    z += mz, iz += mz * x, jz += mz * y;
  }
  PlaneSums total() const {
    return plane_sums(std::array{halves_of(n), halves_of(i), halves_of(j), halves_of(ii),
                                 halves_of(ij), halves_of(jj), halves_of(z), halves_of(iz),
                                 halves_of(jz)});
  }
};

inline void close_sums(const HeightMap& map, PlaneSums& sums) noexcept {
  constexpr int kReach = 3;
  constexpr float kReach4 = 51.0f;  // 4 * 3.6^2
  const int reach = map.ns < kReach ? map.ns : kReach;
  const auto twice_sign = static_cast<float>(2 * map.sign);
  LaneSums9 s;
  const RowLanes x = kAlong - static_cast<float>(kReach);
  // Beyond i = 4 there may be columns of the next row.
  const RowLanes four_xx = 4.0f * x * x;
  const signed char* row =
      map.height.data() + (map.ns - reach) * map.lanes + map.lanes / 2 - kReach;
  for (int j = -reach; j <= reach; ++j, row += map.lanes) {
    const auto y = static_cast<float>(j);
    const RowLanes z2 = heights(row) * twice_sign + 1.0f;
    // kNone is far out of it.
    s.add(at_most(four_xx + 4.0f * y * y + z2 * z2, kReach4), x, y, z2);
  }
  sums = s.total();
}

inline void half_sums(const HeightMap& map, std::array<PlaneSums, kHalves>& sums) noexcept {
  for (int d = 0; d < kHalves; ++d) {
    LaneSums9 s;
    for (int lane = 0; lane < 16; lane += kRowStep) {
      for_disc(map, lane,
               [&](const RowMask& found, const RowLanes& x, float y, const RowLanes& z2, int row) {
                 s.add(both(found, in_half(d, row, lane)), x, y, z2);
               });
    }
    sums[static_cast<std::size_t>(d)] = s.total();
  }
}

inline RowLanes residual_across(const HeightPlane& plane, const RowLanes& x, float y,
                                const RowLanes& z2) {
  return (z2 * 0.5f - (plane.c0 + plane.c2 * y) - plane.c1 * x) * plane.cosine;
}

inline void sums_on_plane(const HeightMap& map, int half, const HeightPlane& plane,
                          PlaneSums& sums) noexcept {
  LaneSums9 s;
  for (int lane = 0; lane < 16; lane += kRowStep) {
    for_disc(map, lane,
             [&](const RowMask& found, const RowLanes& x, float y, const RowLanes& z2, int row) {
               const RowMask on = at_most(abs(residual_across(plane, x, y, z2)), plane.slack);
               s.add(both(both(found, on), in_half(half, row, lane)), x, y, z2);
             });
  }
  sums = s.total();
}

inline void residuals_on_plane(const HeightMap& map, int half, const HeightPlane& first,
                               const HeightPlane& plane, Residuals& residuals) noexcept {
  RowLanes largest{};
  Lanes total{};
  for (int lane = 0; lane < 16; lane += kRowStep) {
    RowLanes squares{};
    for_disc(map, lane,
             [&](const RowMask& found, const RowLanes& x, float y, const RowLanes& z2, int row) {
               const RowMask on = at_most(abs(residual_across(first, x, y, z2)), first.slack);
               const RowLanes r = where(both(both(found, on), in_half(half, row, lane)),
                                        residual_across(plane, x, y, z2));
               largest = larger(largest, abs(r));
               squares += r * r;
             });
    add_row(total, squares);
  }
  residuals.largest = largest_of(largest);
  residuals.sum_squares = sum_of(total);
}

// --- Points in a ball ---------------------------------------------------------------------------

/// Appends the lanes in a mask; beyond them a row's may be written.
class PointWriter {
 public:
  explicit PointWriter(TiltedPoints& points) : points_(points) {}

  void append(const RowMask& mask, const RowLanes& weight, const RowLanes& u, const RowLanes& w,
              const RowLanes& n) {
#if defined(__AVX512F__)
    const auto put = [&](const RowLanes& v, float* to) {
      _mm512_storeu_ps(to + count_, _mm512_maskz_compress_ps(mask, v));
    };
    put(weight, points_.weight), put(u, points_.u), put(w, points_.w), put(n, points_.n);
#elif defined(__AVX2__)
    const __m256i from = to_front(bits_of(mask));
    const auto put = [&](const RowLanes& v, float* to) {
      store(_mm256_permutevar8x32_ps(v, from), to + count_);
    };
    put(weight, points_.weight), put(u, points_.u), put(w, points_.w), put(n, points_.n);
#else
    for (int lane = 0, to = count_; lane < kRowStep; ++lane) {
      if (mask[lane] == 0) continue;
      points_.weight[to] = weight[lane], points_.u[to] = u[lane];
      points_.w[to] = w[lane], points_.n[to] = n[lane];
      ++to;
    }
#endif
    count_ += count_of(mask);
  }
  void finish() {
    for (int k = 0; k < TiltedPoints::kTogether; k += kLaneCount) {
      store(Lanes{}, points_.weight + count_ + k), store(Lanes{}, points_.u + count_ + k);
      store(Lanes{}, points_.w + count_ + k), store(Lanes{}, points_.n + count_ + k);
    }
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
  const int middle = map.lanes / 2, first = (middle - reach) & -kRowStep;
  const float limit = radius * radius, fall = 1.0f / (1.05f * limit);
  // By value: what is stored below could be what a reference refers to.
  const auto [u0, u1, u2] = frame.u;
  const auto [w0, w1, w2] = frame.w;
  const auto [n0, n1, n2] = frame.n;
  const auto sign = static_cast<float>(map.sign);
  const int lanes = map.lanes;
  // What the columns of all rows have in common.
  struct Along {
    RowLanes xx, u, w, n;
  };
  Along along[HeightMap::kMaxLanes / kRowStep];
  int parts = 0;
  for (int at = first; at <= middle + reach; at += kRowStep, ++parts) {
    const RowLanes x = kAlong + static_cast<float>(at - middle);
    along[parts] = {x * x, x * (u0 * unit), x * (w0 * unit), x * (n0 * unit)};
  }
  PointWriter writer(points);
  const signed char* row = map.height.data() + (map.ns - reach) * lanes + first;
  for (int j = -reach; j <= reach; ++j, row += lanes) {
    const auto y = static_cast<float>(j);
    const float yy = y * y, y_unit = y * unit, y_u = y_unit * u1, y_w = y_unit * w1,
                y_n = y_unit * n1;
    for (int part = 0; part < parts; ++part) {
      const auto& [xx, x_u, x_w, x_n] = along[part];
      // The surface is half a voxel beyond the centre of the outermost solid voxel.
      const RowLanes z = heights(row + part * kRowStep) * sign + 0.5f, z_unit = z * unit;
      const RowLanes r2 = xx + yy + z * z;
      // kNone is far out of every ball.
      writer.append(at_most(r2, limit), 1.0f - r2 * fall, x_u + y_u + z_unit * u2,
                    x_w + y_w + z_unit * w2, x_n + y_n + z_unit * n2);
    }
  }
  writer.finish();
}

/// Sixteen sums side by side, over points that are taken sixteen at a time: all at once, or those
/// of the first eights and of the second ones. `from` is 0, then 8.
template <std::size_t kSums, class Add>
inline std::array<float, kSums> sum_points(const TiltedPoints& points, const Add& add) {
  std::array<Lanes, kSums> total;
  for (int from = 0; from < TiltedPoints::kTogether; from += kRowStep) {
    RowLanes sums[kSums]{};
    for (int k = from; k < points.count; k += TiltedPoints::kTogether) add(k, sums);
#pragma GCC unroll 16
    for (std::size_t f = 0; f < kSums; ++f) {
      if (from == 0) {
        total.begin()[f] = halves_of(sums[f]);
      } else {
        add_row(total.begin()[f], sums[f]);
      }
    }
  }
  return sum_all(total);
}

// In two passes: the sums of one take all the registers there are.
inline void tilted_moments(const TiltedPoints& points, TiltedMoments& moments) noexcept {
  const TiltedPoints& p = points;
  auto& m = moments.m;
  auto& z = moments.z;
  const auto low = sum_points<12>(p, [&](int k, RowLanes* s) {
    const RowLanes weight = load_row(p.weight + k), u = load_row(p.u + k), w = load_row(p.w + k),
                   n = load_row(p.n + k);
    const RowLanes w1 = weight * w, u1 = weight * u, w2 = w1 * w, uw = u1 * w, u2 = u1 * u;
    s[0] += weight, s[1] += w1, s[2] += w2, s[3] += u1, s[4] += uw, s[5] += u2;
    s[6] += weight * n, s[7] += w1 * n, s[8] += w2 * n;
    s[9] += u1 * n, s[10] += uw * n, s[11] += u2 * n;
  });
  m[0][0] = low[0], m[0][1] = low[1], m[0][2] = low[2];
  m[1][0] = low[3], m[1][1] = low[4], m[2][0] = low[5];
  z[0][0] = low[6], z[0][1] = low[7], z[0][2] = low[8];
  z[1][0] = low[9], z[1][1] = low[10], z[2][0] = low[11];
  const auto high = sum_points<9>(p, [&](int k, RowLanes* s) {
    const RowLanes weight = load_row(p.weight + k), u = load_row(p.u + k), w = load_row(p.w + k);
    const RowLanes w2 = weight * w * w, w3 = w2 * w, uw2 = w2 * u;
    const RowLanes u2 = weight * u * u, u3 = u2 * u, u2w = u2 * w;
    s[0] += w3, s[1] += w3 * w, s[2] += uw2, s[3] += uw2 * w;
    s[4] += u2w, s[5] += u2w * w, s[6] += u3, s[7] += u3 * w, s[8] += u3 * u;
  });
  m[0][3] = high[0], m[0][4] = high[1], m[1][2] = high[2], m[1][3] = high[3];
  m[2][1] = high[4], m[2][2] = high[5];
  m[3][0] = high[6], m[3][1] = high[7], m[4][0] = high[8];
}

inline RowLanes residual_of(const TiltedPoints& p, int k, const Quadric& c) {
  const RowLanes u = load_row(p.u + k), w = load_row(p.w + k);
  return load_row(p.n + k) - (c[0] + (c[1] + c[3] * u + c[4] * w) * u + (c[2] + c[5] * w) * w);
}

inline void tilted_residuals(const TiltedPoints& points, const Quadric& c,
                             Residuals& residuals) noexcept {
  RowLanes largest{};
  const auto squares = sum_points<1>(points, [&](int k, RowLanes* s) {
    const RowLanes r = where(above(load_row(points.weight + k), 0.0f), residual_of(points, k, c));
    largest = larger(largest, abs(r));
    s[0] += r * r;
  });
  residuals.largest = largest_of(largest);
  residuals.sum_squares = squares[0];
}

inline void sharpen_points(const Quadric& c, TiltedPoints& points) noexcept {
  for (int k = 0; k < points.count; k += kRowStep) {
    const RowLanes r = residual_of(points, k, c);
    store_row(load_row(points.weight + k) * r * r, points.weight + k);
    store_row(r, points.n + k);
  }
}

}  // namespace

}  // namespace sulcus
