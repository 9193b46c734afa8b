#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace sulcus {

/// Coefficients of a quadric, z = c0 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2.
inline constexpr int kQuadric = 6;
template <class Number>
using QuadricOf = std::array<Number, kQuadric>;
using Quadric = QuadricOf<float>;

/// Weighted sums over the heights of a map, by the powers of a quadric: weight times 1, i, j, i^2,
/// i j, j^2 times height. Whole numbers.
using QuadricSums = std::array<std::int32_t, kQuadric>;

/// From the sums to the coefficients: the inverse of the normal equations, most of which is zero by
/// parity. The sums are taken about the height at the centre first, so that a level map gives
/// exactly its level and nothing else.
template <class Integer, class Number>
struct FilterSolutionOf {
  Integer weights, weights_ii;         // sums of the weights, and of weight times i^2 (or j^2)
  Number value, value_curvature;       // c0 to the sums of 1, and of i^2 or j^2
  Number curvature, curvature_across;  // c3 to the sums of i^2, j^2
  Number slope, twist;                 // c1 to the sum of i, c4 to that of i j
};
using FilterSolution = FilterSolutionOf<std::int32_t, float>;

/// What the least-squares filters of a map's quadric make of powers that it does not have; the
/// others follow by exchanging x and y, and by parity the rest is zero.
template <class Number>
struct FilterAnswersOf {
  Number slope_x3, slope_xy2;                         // c1 to x^3, x y^2
  Number value_x4, value_x2y2;                        // c0 to x^4, x^2 y^2
  Number curvature_x4, curvature_x2y2, curvature_y4;  // c3 to x^4, x^2 y^2, y^4
  Number twist_x3y;                                   // c4 to x^3 y
};
using FilterAnswers = FilterAnswersOf<float>;

/// Height over the plane of a map's columns of a surface that is a quadric in its own tangent
/// frame, map space: voxels, z outward.
///
/// With slopes s and Hessian H of the height at the origin, g^2 = 1 / (1 + |s|^2), and
/// z2 = 1/2 x'Hx, the surface n'X = 1/2 X'KX solves order by order to
///   z3 = z2 t,  t = g^2 s'Hx,   z4 = z2 t^2 + 1/2 g^2 (g^2 s'Hs) z2^2,
/// so that tilted a quadric has a cubic and a quartic part over the columns, given by its slopes
/// and curvatures. Ignoring them tilts the fit: by 0.8 degrees and more 34 degrees down a cap of 30
/// voxels' radius (ColumnQuadric test).
template <class Number>
struct ColumnQuadricOf {
  QuadricOf<Number> c{};  // to second order
  Number t_x{}, t_y{};    // t = t_x x + t_y y
  Number quartic{};       // 1/2 g^2 (g^2 s'Hs)
};
using ColumnQuadric = ColumnQuadricOf<float>;

/// The nearest point of a surface to the origin: unit normal there, and how far out along it.
template <class Number>
struct ClosestPointOf {
  Number normal_x{}, normal_y{}, normal_z{};
  Number offset{};
};
using ClosestPoint = ClosestPointOf<float>;

// The numbers are floats or vectors of them: the same operations in the same order either way. What
// x and y have in common is added up first, so that exchanging them exchanges the results to the
// bit. Always inline: two files instantiate them for vectors, in two instruction sets, and the
// linker would keep one for both.
#define SULCUS_EVERY_SET [[gnu::always_inline]] inline

/// Coefficients in columns, z outward and half a voxel beyond the centre of the outermost solid
/// voxel. `sums` of heights whose centre's is `centre`; `level` is what that is over the voxel.
/// `number` makes numbers of integers.
template <class Integer, class Number, class ToNumber>
SULCUS_EVERY_SET QuadricOf<Number> quadric_of(const std::array<Integer, kQuadric>& sums,
                                              const Integer& centre, const Integer& level,
                                              const Number& sign,
                                              const FilterSolutionOf<Integer, Number>& s,
                                              const ToNumber& number) noexcept {
  const Number one = sign * number(sums[0] - centre * s.weights);
  const Number ii = sign * number(sums[3] - centre * s.weights_ii);
  const Number jj = sign * number(sums[5] - centre * s.weights_ii);
  return {sign * number(level) + 0.5f + (s.value * one + s.value_curvature * (ii + jj)),
          s.slope * (sign * number(sums[1])),
          s.slope * (sign * number(sums[2])),
          s.value_curvature * one + (s.curvature * ii + s.curvature_across * jj),
          s.twist * (sign * number(sums[4])),
          s.value_curvature * one + (s.curvature_across * ii + s.curvature * jj)};
}

template <class Number>
SULCUS_EVERY_SET void complete(ColumnQuadricOf<Number>& q) noexcept {
  const auto& c = q.c;
  const Number g2 = 1.0f / (1.0f + (c[1] * c[1] + c[2] * c[2]));
  q.t_x = g2 * (2.0f * c[3] * c[1] + c[4] * c[2]);
  q.t_y = g2 * (c[4] * c[1] + 2.0f * c[5] * c[2]);
  q.quartic = 0.5f * g2 * (q.t_x * c[1] + q.t_y * c[2]);
}

/// The quadric whose heights give these coefficients, in columns, under a filter with these
/// answers, `stride` voxels apart: what the filter makes of the cubic and quartic part is taken
/// off, as far as the coefficients give it. Once is enough: a second time changes a
/// tooth's normals by 0.01 degrees.
template <class Number>
SULCUS_EVERY_SET ColumnQuadricOf<Number> column_quadric(const QuadricOf<Number>& fitted,
                                                        const FilterAnswersOf<Number>& answers,
                                                        float stride) noexcept {
  const float per = 1.0f / stride, per2 = per * per, second = stride * stride,
              fourth = second * second;
  ColumnQuadricOf<Number> q;
  q.c = {fitted[0],        fitted[1] * per,  fitted[2] * per,
         fitted[3] * per2, fitted[4] * per2, fitted[5] * per2};
  complete(q);
  const QuadricOf<Number> c = q.c;
  const Number tx = q.t_x, ty = q.t_y, k = q.quartic;
  const Number x3 = c[3] * tx, x2y = c[3] * ty + c[4] * tx;
  const Number xy2 = c[5] * tx + c[4] * ty, y3 = c[5] * ty;
  const Number txx = tx * tx, txy = 2.0f * tx * ty, tyy = ty * ty;
  const Number x4 = c[3] * (txx + k * c[3]);
  const Number x3y = c[3] * txy + c[4] * (txx + 2.0f * k * c[3]);
  const Number x2y2 =
      (c[3] * tyy + c[5] * txx) + (c[4] * (txy + k * c[4]) + 2.0f * k * (c[3] * c[5]));
  const Number xy3 = c[5] * txy + c[4] * (tyy + 2.0f * k * c[5]);
  const Number y4 = c[5] * (tyy + k * c[5]);
  const FilterAnswersOf<Number>& a = answers;
  q.c[0] = c[0] - fourth * (a.value_x4 * (x4 + y4) + a.value_x2y2 * x2y2);
  q.c[1] = c[1] - second * (a.slope_x3 * x3 + a.slope_xy2 * xy2);
  q.c[2] = c[2] - second * (a.slope_x3 * y3 + a.slope_xy2 * x2y);
  q.c[3] = c[3] - second * ((a.curvature_x4 * x4 + a.curvature_y4 * y4) + a.curvature_x2y2 * x2y2);
  q.c[4] = c[4] - second * a.twist_x3y * (x3y + xy3);
  q.c[5] = c[5] - second * ((a.curvature_x4 * y4 + a.curvature_y4 * x4) + a.curvature_x2y2 * x2y2);
  complete(q);
  return q;
}

/// What a quadric leaves of a map's heights, outward, in voxels: with weights as the filter's whole
/// numbers, sums of weight times 1, i, j, i^2, i j, j^2 times residual^3.
template <class Number>
using ResidualCubesOf = QuadricOf<Number>;
using ResidualCubes = ResidualCubesOf<float>;

/// A step from least squares towards the least sum of fourth powers. Quantisation leaves residuals
/// spread evenly up to a bound, not in a bell, so that those near to it say most. It is Newton's,
/// but for the squared residuals, which are taken to be 1/12 everywhere, as quantisation leaves
/// them: so the filter's own solution serves, and none overshoots where residuals are small.
template <class Integer, class Number>
SULCUS_EVERY_SET void sharpen(const FilterSolutionOf<Integer, Number>& s,
                              const ResidualCubesOf<Number>& cubes, float stride,
                              ColumnQuadricOf<Number>& q) noexcept {
  const float share = 12.0f / 3.0f, per = share / stride, per2 = per / stride;
  const Number curvatures = cubes[3] + cubes[5];
  q.c[0] += share * (s.value * cubes[0] + s.value_curvature * curvatures);
  q.c[1] += per * (s.slope * cubes[1]);
  q.c[2] += per * (s.slope * cubes[2]);
  q.c[3] += per2 * (s.value_curvature * cubes[0] +
                    (s.curvature * cubes[3] + s.curvature_across * cubes[5]));
  q.c[4] += per2 * (s.twist * cubes[4]);
  q.c[5] += per2 * (s.value_curvature * cubes[0] +
                    (s.curvature_across * cubes[3] + s.curvature * cubes[5]));
  complete(q);
}

/// By a step along the normal from the point above the origin: on the flat surfaces of a map the
/// rest is far below the noise of its heights. `square_root` is that of the numbers.
template <class Number, class SquareRoot>
SULCUS_EVERY_SET ClosestPointOf<Number> closest_point_of(const ColumnQuadricOf<Number>& q,
                                                         const SquareRoot& square_root) noexcept {
  const auto& c = q.c;
  // At the origin, the step, and there.
  const Number first = -c[0] / (1.0f + (c[1] * c[1] + c[2] * c[2]));
  const Number x = first * c[1], y = first * c[2];
  const Number z2 = (c[3] * x * x + c[5] * y * y) + c[4] * (x * y);
  const Number more = 1.0f + (q.t_x * x + q.t_y * y);
  const Number z = c[0] + (c[1] * x + c[2] * y) + z2 * more;
  const Number slope_x = c[1] + (2.0f * c[3] * x + c[4] * y) * more + z2 * q.t_x;
  const Number slope_y = c[2] + (c[4] * x + 2.0f * c[5] * y) * more + z2 * q.t_y;
  const Number shrink = 1.0f / square_root(1.0f + (slope_x * slope_x + slope_y * slope_y));
  return {-slope_x * shrink, -slope_y * shrink, shrink, (z - (slope_x * x + slope_y * y)) * shrink};
}

#undef SULCUS_EVERY_SET

inline Quadric quadric_of(const QuadricSums& sums, int centre, int level, int sign,
                          const FilterSolution& solution) noexcept {
  return quadric_of<std::int32_t, float>(sums, centre, level, static_cast<float>(sign), solution,
                                         [](std::int32_t v) { return static_cast<float>(v); });
}
inline ClosestPoint closest_point_of(const ColumnQuadric& q) noexcept {
  return closest_point_of(q, [](float v) { return std::sqrt(v); });
}

}  // namespace sulcus
