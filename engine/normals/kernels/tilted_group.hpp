// Eight fits of quadrics and planes to points in frames tilted, side by side, and their closest
// points: loops of map_kernels.hpp, as surface_group.hpp. One alone waits for its own divisions
// most of the time.

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// Normal equations of a quadric, the lower triangle, and their right side.
struct NormalEquations {
  Lanes matrix[kQuadric][kQuadric], right[kQuadric];
};

/// Heights are uniform in [-1/2, 1/2] about the surface, along e = (eu, ew, en) in the frame. To
/// second order, the moment of a power p of the points exceeds the surface's own by half the
/// variance, 1/12, times the second derivative of p along e; of points as they are (`kQuantised`)
/// that is taken off here.
template <bool kQuantised>
inline NormalEquations equations_of(const TiltedGroup& g) {
  const Lanes radius = load(g.radius), half_variance = 1.0f / (24.0f * radius * radius);
  const Lanes eu = load(g.u[2]), ew = load(g.w[2]), en = load(g.n[2]);
  const Lanes uu = eu * eu * half_variance, uw = 2.0f * eu * ew * half_variance,
              ww = ew * ew * half_variance, un = 2.0f * en * eu * half_variance,
              wn = 2.0f * en * ew * half_variance;
  const auto moment = [&](int a, int b) {
    if constexpr (!kQuantised) return load(g.m[a][b]);
    Lanes d{};
    if (a >= 2) d += uu * static_cast<float>(a * (a - 1)) * load(g.m[a - 2][b]);
    if (a >= 1 && b >= 1) d += uw * static_cast<float>(a * b) * load(g.m[a - 1][b - 1]);
    if (b >= 2) d += ww * static_cast<float>(b * (b - 1)) * load(g.m[a][b - 2]);
    return load(g.m[a][b]) - d;
  };
  const auto right = [&](int a, int b) {
    if constexpr (!kQuantised) return load(g.z[a][b]);
    Lanes d{};
    if (a >= 2) d += 2.0f * uu * load(g.z[a - 2][b]);
    if (a >= 1 && b >= 1) d += uw * load(g.z[a - 1][b - 1]);
    if (b >= 2) d += 2.0f * ww * load(g.z[a][b - 2]);
    if (a >= 1) d += un * static_cast<float>(a) * load(g.m[a - 1][b]);
    if (b >= 1) d += wn * static_cast<float>(b) * load(g.m[a][b - 1]);
    return load(g.z[a][b]) - d;
  };
  NormalEquations e;
  auto& m = e.matrix;
  m[0][0] = moment(0, 0);
  m[1][0] = moment(1, 0), m[1][1] = moment(2, 0);
  m[2][0] = moment(0, 1), m[2][1] = moment(1, 1), m[2][2] = moment(0, 2);
  m[3][0] = m[1][1], m[3][1] = moment(3, 0), m[3][2] = moment(2, 1), m[3][3] = moment(4, 0);
  m[4][0] = m[2][1], m[4][1] = m[3][2], m[4][2] = moment(1, 2), m[4][3] = moment(3, 1);
  m[4][4] = moment(2, 2);
  m[5][0] = m[2][2], m[5][1] = m[4][2], m[5][2] = moment(0, 3), m[5][3] = m[4][4];
  m[5][4] = moment(1, 3), m[5][5] = moment(0, 4);
  e.right[0] = right(0, 0), e.right[1] = right(1, 0), e.right[2] = right(0, 1);
  e.right[3] = right(2, 0), e.right[4] = right(1, 1), e.right[5] = right(0, 2);
  return e;
}

struct Pair {
  Lanes x, y;
};
inline Pair operator-(const Pair& a, const Pair& b) { return {a.x - b.x, a.y - b.y}; }
inline Lanes dot(const Pair& a, const Pair& b) { return a.x * b.x + a.y * b.y; }

/// Rows of a matrix of two by two.
struct Block {
  Pair first, second;
};
inline Block operator-(const Block& a, const Block& b) {
  return {a.first - b.first, a.second - b.second};
}
inline Block transposed(const Block& m) {
  return {{m.first.x, m.second.x}, {m.first.y, m.second.y}};
}
inline Pair operator*(const Block& m, const Pair& v) { return {dot(m.first, v), dot(m.second, v)}; }
/// a times b transposed.
inline Block times_transposed(const Block& a, const Block& b) {
  return {{dot(a.first, b.first), dot(a.first, b.second)},
          {dot(a.second, b.first), dot(a.second, b.second)}};
}

struct Inverse {
  Block of;
  IntLanes exists;
};
/// Of a symmetric pivot; none where it is singular, seen from what it was before elimination.
inline Inverse inverse_of(const Block& pivot, const Block& before) {
  const Lanes a = pivot.first.x, c = pivot.second.x, d = pivot.second.y;
  const Lanes determinant = a * d - c * c, one = 1.0f / determinant;
  return {{{d * one, -c * one}, {-c * one, a * one}},
          (a > 1e-6f * before.first.x) & (determinant > 1e-6f * a * before.second.y)};
}

/// Block (i, j) of the equations' matrix, i and j even; its upper half by symmetry.
inline Block block_of(const NormalEquations& e, int i, int j) {
  return {{e.matrix[i][j], i == j ? e.matrix[i + 1][i] : e.matrix[i][j + 1]},
          {e.matrix[i + 1][j], e.matrix[i + 1][j + 1]}};
}

/// By Cholesky's L D L', two rows at a time: half as many divisions wait for one another.
inline void solve_quadrics(const NormalEquations& e, TiltedGroup& g) {
  const Block a00 = block_of(e, 0, 0), a10 = block_of(e, 2, 0), a20 = block_of(e, 4, 0);
  const Block a11 = block_of(e, 2, 2), a21 = block_of(e, 4, 2), a22 = block_of(e, 4, 4);
  const auto [i0, exists0] = inverse_of(a00, a00);
  // The inverses are symmetric.
  const Block l10 = times_transposed(a10, i0), l20 = times_transposed(a20, i0);
  const Block s11 = a11 - times_transposed(l10, a10), s21 = a21 - times_transposed(l20, a10);
  const auto [i1, exists1] = inverse_of(s11, a11);
  const Block l21 = times_transposed(s21, i1);
  const Block s22 = a22 - times_transposed(l20, a20) - times_transposed(l21, s21);
  const auto [i2, exists2] = inverse_of(s22, a22);
  const Pair b0{e.right[0], e.right[1]}, b1{e.right[2], e.right[3]}, b2{e.right[4], e.right[5]};
  const Pair y1 = b1 - l10 * b0, y2 = b2 - l20 * b0 - l21 * y1;
  const Pair x2 = i2 * y2;
  const Pair x1 = i1 * y1 - transposed(l21) * x2;
  const Pair x0 = i0 * b0 - transposed(l10) * x1 - transposed(l20) * x2;
  store(x0.x, g.quadric[0]), store(x0.y, g.quadric[1]), store(x1.x, g.quadric[2]);
  store(x1.y, g.quadric[3]), store(x2.x, g.quadric[4]), store(x2.y, g.quadric[5]);
  store(exists0 & exists1 & exists2, g.has_quadric);
}

/// The same of the first three.
inline void solve_planes(const NormalEquations& e, TiltedGroup& g) {
  const Block a00 = block_of(e, 0, 0);
  const auto [i0, exists0] = inverse_of(a00, a00);
  const Pair a10{e.matrix[2][0], e.matrix[2][1]}, b0{e.right[0], e.right[1]};
  const Pair l10 = i0 * a10;
  const Lanes pivot = e.matrix[2][2] - dot(l10, a10);
  const Lanes x2 = (e.right[2] - dot(l10, b0)) / pivot;
  const Pair x0 = i0 * b0 - Pair{l10.x * x2, l10.y * x2};
  store(x0.x, g.plane[0]), store(x0.y, g.plane[1]), store(x2, g.plane[2]);
  store(exists0 & (pivot > 1e-6f * e.matrix[2][2]), g.has_plane);
}

inline void solve_quantised(TiltedGroup& g) noexcept {
  const NormalEquations e = equations_of<true>(g);
  solve_quadrics(e, g);
  solve_planes(e, g);
}
inline void solve_sharpened(TiltedGroup& g) noexcept { solve_quadrics(equations_of<false>(g), g); }

inline void tilted_closest_points(TiltedGroup& g) noexcept {
  ColumnQuadricOf<Lanes> surface{};  // in units of the radius
  for (unsigned f = 0; f < kQuadric; ++f) surface.c[f] = load(g.quadric[f]);
  const ClosestPointOf<Lanes> tilted = closest_point_of(surface, square_root);
  for (unsigned a = 0; a < 3; ++a) {
    store(tilted.normal_x * load(g.u[a]) + tilted.normal_y * load(g.w[a]) +
              tilted.normal_z * load(g.n[a]),
          g.normal[a]);
  }
  store(tilted.offset * load(g.radius), g.offset);
}

}  // namespace

}  // namespace sulcus
