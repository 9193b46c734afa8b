#include "engine/normals/tilted_fit.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <Eigen/Geometry>

#include "engine/normals/grown_plane.hpp"
#include "engine/normals/map_kernels.hpp"
#include "engine/normals/plane_solution.hpp"

namespace sulcus {

namespace {

using Eigen::Vector3f;

constexpr int kFewestPoints = 12;
constexpr float kFewestClose = 5.0f;
constexpr float kLeastGrown = 0.8f;  // of the points in the ball
// Of residuals across the surface. Quantisation alone gives half the cosine of the tilt at most,
// and 0.289 of it on average.
struct Tolerance {
  float beyond_half_cosine;  // of the largest, voxels
  float mean;                // of the root mean square, share of the cosine
};
constexpr Tolerance kPlane{0.15f, 0.32f}, kCurved{0.27f, 0.35f};

TiltedFrame frame_of(const Vector3f& normal, float radius, const MapSide& side) {
  // The first axis across the rows, so that one component is zero.
  const Vector3f u = Vector3f(normal.z(), 0.0f, -normal.x()).normalized();
  const Vector3f w = normal.cross(u);
  return {{u.x(), u.y(), u.z()},
          {w.x(), w.y(), w.z()},
          {normal.x(), normal.y(), normal.z()},
          radius,
          side};
}

/// Normal equations of a quadric, the lower triangle, and their right side.
struct NormalEquations {
  float matrix[kQuadric][kQuadric], right[kQuadric];
};

/// `half_variance`: of what was added to the points along the columns, to be taken off the moments.
NormalEquations equations_of(const TiltedMoments& s, const TiltedFrame& frame,
                             float half_variance) {
  const float eu = frame.u[2], ew = frame.w[2], en = frame.n[2];
  const float uu = eu * eu * half_variance, uw = 2.0f * eu * ew * half_variance,
              ww = ew * ew * half_variance, un = 2.0f * en * eu * half_variance,
              wn = 2.0f * en * ew * half_variance;
  const auto moment = [&](int a, int b) {
    float d = 0.0f;
    if (a >= 2) d += uu * static_cast<float>(a * (a - 1)) * s.m[a - 2][b];
    if (a >= 1 && b >= 1) d += uw * static_cast<float>(a * b) * s.m[a - 1][b - 1];
    if (b >= 2) d += ww * static_cast<float>(b * (b - 1)) * s.m[a][b - 2];
    return s.m[a][b] - d;
  };
  const auto right = [&](int a, int b) {
    float d = 0.0f;
    if (a >= 2) d += 2.0f * uu * s.z[a - 2][b];
    if (a >= 1 && b >= 1) d += uw * s.z[a - 1][b - 1];
    if (b >= 2) d += 2.0f * ww * s.z[a][b - 2];
    if (a >= 1) d += un * static_cast<float>(a) * s.m[a - 1][b];
    if (b >= 1) d += wn * static_cast<float>(b) * s.m[a][b - 1];
    return s.z[a][b] - d;
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
  const float z[kQuadric] = {right(0, 0), right(1, 0), right(0, 1),
                             right(2, 0), right(1, 1), right(0, 2)};
  std::copy(std::begin(z), std::end(z), e.right);
  return e;
}

/// Heights are uniform in [-1/2, 1/2] about the surface, along e = (eu, ew, en) in the frame. To
/// second order, the moment of a power p of the points exceeds the surface's own by half the
/// variance, 1/12, times the second derivative of p along e; that is taken off here.
NormalEquations without_quantisation(const TiltedMoments& s, const TiltedFrame& frame) {
  return equations_of(s, frame, 1.0f / (24.0f * frame.radius * frame.radius));
}

using Block = Eigen::Matrix2f;
using Pair = Eigen::Vector2f;

/// Of a symmetric pivot. False where it is singular, seen from what it was before elimination.
bool invert(const Block& pivot, const Block& before, Block& inverse) {
  const float a = pivot(0, 0), c = pivot(1, 0), d = pivot(1, 1);
  const float determinant = a * d - c * c, one = 1.0f / determinant;
  inverse << d * one, -c * one, -c * one, a * one;
  return a > 1e-6f * before(0, 0) && determinant > 1e-6f * a * before(1, 1);
}

/// Coefficients, or none where the points do not determine them. By Cholesky's L D L', two rows at
/// a time: half as many divisions wait for one another.
std::optional<Quadric> solve_quadric(const NormalEquations& e) {
  const auto block = [&](int i, int j) {
    Block m;
    m << e.matrix[i][j], i == j ? e.matrix[i + 1][i] : e.matrix[i][j + 1], e.matrix[i + 1][j],
        e.matrix[i + 1][j + 1];
    return m;
  };
  const Block a00 = block(0, 0), a10 = block(2, 0), a20 = block(4, 0);
  const Block a11 = block(2, 2), a21 = block(4, 2), a22 = block(4, 4);
  Block i0, i1, i2;
  if (!invert(a00, a00, i0)) return {};
  const Block l10 = a10 * i0, l20 = a20 * i0;
  const Block s11 = a11 - l10 * a10.transpose(), s21 = a21 - l20 * a10.transpose();
  if (!invert(s11, a11, i1)) return {};
  const Block l21 = s21 * i1;
  const Block s22 = a22 - l20 * a20.transpose() - l21 * s21.transpose();
  if (!invert(s22, a22, i2)) return {};
  const Pair b0(e.right[0], e.right[1]), b1(e.right[2], e.right[3]), b2(e.right[4], e.right[5]);
  const Pair y1 = b1 - l10 * b0, y2 = b2 - l20 * b0 - l21 * y1;
  const Pair x2 = i2 * y2;
  const Pair x1 = i1 * y1 - l21.transpose() * x2;
  const Pair x0 = i0 * b0 - l10.transpose() * x1 - l20.transpose() * x2;
  return Quadric{x0.x(), x0.y(), x1.x(), x1.y(), x2.x(), x2.y()};
}

/// The same of the first three.
std::optional<Quadric> solve_plane(const NormalEquations& e) {
  Block a00, i0;
  a00 << e.matrix[0][0], e.matrix[1][0], e.matrix[1][0], e.matrix[1][1];
  if (!invert(a00, a00, i0)) return {};
  const Pair a10(e.matrix[2][0], e.matrix[2][1]), b0(e.right[0], e.right[1]);
  const Pair l10 = i0 * a10;
  const float pivot = e.matrix[2][2] - l10.dot(a10);
  if (!(pivot > 1e-6f * e.matrix[2][2])) return {};
  const float x2 = (e.right[2] - l10.dot(b0)) / pivot;
  const Pair x0 = i0 * b0 - l10 * x2;
  return Quadric{x0.x(), x0.y(), x2};
}

bool explains(const Quadric& c, const TiltedPoints& points, const TiltedFrame& frame,
              const Tolerance& tolerance) {
  Residuals residuals;
  map_kernels().residuals(points, c, residuals);
  const float cosine = frame.n[2];
  const float mean_square = tolerance.mean * std::max(cosine, 0.2f) / frame.radius;
  return residuals.largest * frame.radius <= tolerance.beyond_half_cosine + 0.5f * cosine &&
         residuals.sum_squares <= static_cast<float>(points.count) * mean_square * mean_square;
}

/// The foot of the voxel's centre on a surface over a tilted frame, told in map space.
Foot foot_in_columns(const Quadric& c, const TiltedFrame& frame) {
  ColumnQuadric surface;  // in units of the radius
  surface.c = c;
  const Foot tilted = foot_of(surface);
  const auto along = [&](std::size_t axis) {
    return tilted.normal_x * frame.u[axis] + tilted.normal_y * frame.w[axis] +
           tilted.normal_z * frame.n[axis];
  };
  return {along(0), along(1), along(2), tilted.offset * frame.radius};
}

}  // namespace

std::optional<Foot> close_plane(const HeightMap& map) noexcept {
  PlaneSums sums;
  map_kernels().close_sums(map, sums);
  if (sums.n < kFewestClose) return {};
  const std::optional<PlaneSolution> twice = solve_plane(sums);
  if (!twice) return {};
  const float slope_x = 0.5f * twice->c1, slope_y = 0.5f * twice->c2;
  const float cosine = 1.0f / std::sqrt(1.0f + slope_x * slope_x + slope_y * slope_y);
  return Foot{-slope_x * cosine, -slope_y * cosine, cosine, 0.5f * twice->c0 * cosine};
}

std::optional<Foot> fit_tilted(const HeightMap& map, const Vector3f& normal, float radius,
                               const MapSide& side) noexcept {
  const MapKernels& kernels = map_kernels();
  const TiltedFrame frame = frame_of(normal, radius, side);
  TiltedPoints points;
  kernels.gather(map, frame, points);
  if (points.count < kFewestPoints) return {};
  TiltedMoments moments;
  kernels.moments(points, moments);
  const NormalEquations equations = without_quantisation(moments, frame);

  std::optional<Quadric> c = solve_quadric(equations);
  if (!c || !explains(*c, points, frame, kCurved)) return {};
  const std::optional<Quadric> plane = solve_plane(equations);
  if (plane && explains(*plane, points, frame, kPlane)) {
    const Foot in_ball = foot_in_columns(*plane, frame);
    const auto least = static_cast<int>(kLeastGrown * static_cast<float>(points.count));
    const std::optional<Foot> face = grow_plane(map, in_ball, least, true);
    return face ? *face : in_ball;
  }
  // A step of Newton's towards the least sum of fourth powers: what quantisation leaves is spread
  // evenly up to a bound, so that the points near to it say most (see grow_plane).
  kernels.sharpen_points(*c, points);
  kernels.moments(points, moments);
  if (const std::optional<Quadric> thrice = solve_quadric(equations_of(moments, frame, 0.0f))) {
    for (std::size_t f = 0; f < kQuadric; ++f) (*c)[f] += (*thrice)[f] * (1.0f / 3.0f);
  }
  return foot_in_columns(*c, frame);
}

}  // namespace sulcus
