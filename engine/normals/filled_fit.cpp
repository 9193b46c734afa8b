#include "engine/normals/filled_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "engine/normals/ldm_tuning.hpp"
#include "engine/normals/quadric_filter.hpp"

namespace sulcus {

namespace {

constexpr float kPerPart = 1.0f / kHeightParts;

/// Sums of a filter over the heights, less that at the centre.
std::array<std::int64_t, kQuadric> filter_sums(const FilledMap& map, const QuadricFilter& filter) {
  std::array<std::int64_t, kQuadric> sums{};
  const std::int32_t centre = map.at(0, 0);
  for (int row = 0; row <= 2 * map.ns; ++row) {
    const std::size_t first = static_cast<std::size_t>(row * map.lanes);
    for (std::size_t f = 0; f < kQuadric; ++f) {
      std::int32_t sum = 0;  // of a row it stays below 2^31 at every neighbourhood
      for (std::size_t lane = 0; lane < static_cast<std::size_t>(map.lanes); ++lane) {
        sum += filter.coefficient[f][first + lane] * (map.height[first + lane] - centre);
      }
      sums[f] += sum;
    }
  }
  return sums;
}

/// Largest distance of the heights from the surface, along the columns, voxels.
float largest_residual(const FilledMap& map, const ColumnQuadric& q) {
  float largest = 0.0f;
  for (int j = -map.ns; j <= map.ns; ++j) {
    const auto y = static_cast<float>(j);
    for (int i = -map.ns; i <= map.ns; ++i) {
      const auto x = static_cast<float>(i);
      const float z2 = (q.c[3] * x * x + q.c[5] * y * y) + q.c[4] * (x * y);
      const float t = q.t_x * x + q.t_y * y;
      const float z =
          q.c[0] + (q.c[1] * x + q.c[2] * y) + z2 * (1.0f + t + t * t) + q.quartic * (z2 * z2);
      largest = std::max(largest, std::abs(static_cast<float>(map.at(i, j)) * kPerPart - z));
    }
  }
  return largest;
}

}  // namespace

std::optional<ClosestPoint> fit_whole_filled(const FilledMap& map, float tolerance) noexcept {
  if (!map.whole || map.ns < 2) return {};
  const QuadricFilter& filter = quadric_filter(map.ns, map.lanes);
  const auto sums = filter_sums(map, filter);
  const FilterSolution& s = filter.solution;
  const auto number = [&](std::size_t f) { return static_cast<float>(sums[f]) * kPerPart; };
  const float one = number(0), ii = number(3), jj = number(5);
  const float centre = static_cast<float>(map.at(0, 0)) * kPerPart;
  const Quadric fitted{centre + (s.value * one + s.value_curvature * (ii + jj)),
                       s.slope * number(1),
                       s.slope * number(2),
                       s.value_curvature * one + (s.curvature * ii + s.curvature_across * jj),
                       s.twist * number(4),
                       s.value_curvature * one + (s.curvature_across * ii + s.curvature * jj)};
  ColumnQuadric surface = column_quadric(fitted, filter.answers, 1.0f);
  const float cosine =
      1.0f / std::sqrt(1.0f + (surface.c[1] * surface.c[1] + surface.c[2] * surface.c[2]));
  if (!(largest_residual(map, surface) * cosine <= tolerance)) return {};
  // A column's mean height is above that at its middle by 1/24 of the second derivatives.
  surface.c[0] -= (surface.c[3] + surface.c[5]) * (1.0f / 12.0f);
  return closest_point_of(surface);
}

float height_noise(const FilledMap& map) noexcept {
  std::array<float, 64> squares;
  std::size_t count = 0;
  for (int v = -map.ns + 1; v < map.ns; v += 3) {
    for (int u = -map.ns + 1; u < map.ns && count < squares.size(); u += 3) {
      int sum = 0, along_i = 0, along_j = 0, products = 0;
      bool found = true;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          const int height = map.at(u + i, v + j);
          found &= height != FilledMap::kNone;
          const int above = height - map.at(u, v);
          sum += above, along_i += i * above, along_j += j * above, products += above * above;
        }
      }
      if (!found) continue;
      const auto square = [](int n) { return static_cast<float>(n) * static_cast<float>(n); };
      const float left = static_cast<float>(products) - square(sum) / 9.0f -
                         (square(along_i) + square(along_j)) / 6.0f;
      squares[count++] = left / 6.0f;  // nine heights less three parameters
    }
  }
  if (count < 4) return 0.0f;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(squares.begin(), middle, squares.begin() + static_cast<std::ptrdiff_t>(count));
  return std::sqrt(std::max(*middle, 0.0f)) * kPerPart;
}

void FilledFitter::gather(const FilledMap& map, const Eigen::Vector3f& normal,
                          float radius) noexcept {
  const Eigen::Vector3f u = Eigen::Vector3f(normal.z(), 0.0f, -normal.x()).normalized();
  const Eigen::Vector3f w = normal.cross(u);
  frame_ = {{u.x(), u.y(), u.z()},
            {w.x(), w.y(), w.z()},
            {normal.x(), normal.y(), normal.z()},
            radius,
            {}};
  const float limit = radius * radius, fall = 1.0f / (1.05f * limit), unit = 1.0f / radius;
  const int reach = std::min(map.ns, static_cast<int>(radius));
  int count = 0;
  for (int j = -reach; j <= reach; ++j) {
    const auto y = static_cast<float>(j);
    for (int i = -reach; i <= reach; ++i) {
      const auto x = static_cast<float>(i);
      const float z = static_cast<float>(map.at(i, j)) * kPerPart;  // kNone is far outside
      const float r2 = x * x + y * y + z * z;
      if (!(r2 <= limit)) continue;
      const auto n = static_cast<std::size_t>(count++);
      all_.weight[n] = 1.0f - r2 * fall;
      all_.u[n] = (x * u.x() + y * u.y() + z * u.z()) * unit;
      all_.w[n] = (x * w.x() + y * w.y() + z * w.z()) * unit;
      all_.n[n] = (x * normal.x() + y * normal.y() + z * normal.z()) * unit;
      i_[n] = x;
      j_[n] = y;
    }
  }
  all_.count = count;
  for (int n = count; n < count + TiltedPoints::kTogether; ++n) {
    all_.weight[n] = all_.u[n] = all_.w[n] = all_.n[n] = 0.0f;
  }
}

bool FilledFitter::explains(const Quadric& quadric, const TiltedPoints& points,
                            float tolerance) const noexcept {
  Residuals residuals;
  map_kernels().residuals(points, quadric, residuals);
  return residuals.largest * frame_.radius <= tolerance;
}

std::optional<ClosestPoint> FilledFitter::fit_ball(float tolerance) noexcept {
  if (all_.count < kFewestPointsInBall) return {};
  const MapKernels& kernels = map_kernels();
  TiltedMoments moments;
  kernels.moments(all_, moments);
  group_.put_frame(0, frame_);
  group_.put_moments(0, moments);
  kernels.solve_points(group_);
  if (group_.has_quadric[0] == 0 || !explains(group_.quadric_at(0), all_, tolerance)) return {};
  kernels.tilted_closest_points(group_);
  return group_.closest_point(0);
}

FilledFitter::Side FilledFitter::take_side(const MapSide& side,
                                           TiltedPoints& points) const noexcept {
  float nearest = 1e9f, farthest = -1e9f;
  int count = 0;
  const auto size = static_cast<std::size_t>(all_.count);
  for (std::size_t n = 0; n < size; ++n) {
    const float along = i_[n] * side.x + j_[n] * side.y;
    if (along < -side.behind) continue;
    nearest = std::min(nearest, along), farthest = std::max(farthest, along);
    const auto to = static_cast<std::size_t>(count++);
    points.weight[to] = all_.weight[n];
    points.u[to] = all_.u[n], points.w[to] = all_.w[n], points.n[to] = all_.n[n];
  }
  points.count = count;
  for (int n = count; n < count + TiltedPoints::kTogether; ++n) {
    points.weight[n] = points.u[n] = points.w[n] = points.n[n] = 0.0f;
  }
  return {count, farthest - nearest};
}

void FilledFitter::fit_sides(std::span<const MapSide> sides, float tolerance,
                             std::span<std::optional<ClosestPoint>> closest) noexcept {
  const MapKernels& kernels = map_kernels();
  std::array<Side, TiltedGroup::kSize> taken;
  for (std::size_t first = 0; first < sides.size(); first += taken.size()) {
    const std::size_t count = std::min(taken.size(), sides.size() - first);
    TiltedMoments moments;
    for (std::size_t k = 0; k < count; ++k) {
      taken[k] = take_side(sides[first + k], of_sides_[k]);
      kernels.moments(of_sides_[k], moments);
      group_.put_frame(static_cast<int>(k), frame_);
      group_.put_moments(static_cast<int>(k), moments);
    }
    kernels.solve_points(group_);
    std::array<bool, TiltedGroup::kSize> found{};
    for (std::size_t k = 0; k < count; ++k) {
      const auto lane = static_cast<int>(k);
      const TiltedPoints& points = of_sides_[k];
      found[k] = group_.has_quadric[k] != 0 && taken[k].count >= kFewestPointsInBall &&
                 taken[k].width >= kLeastQuadricWidth &&
                 explains(group_.quadric_at(lane), points, tolerance);
      if (found[k]) continue;
      const Quadric plane{group_.plane[0][k], group_.plane[1][k], group_.plane[2][k]};
      group_.put_quadric(lane, plane);
      found[k] = group_.has_plane[k] != 0 && taken[k].count >= kFewestPointsOnSide &&
                 taken[k].width >= kLeastPlaneWidth && explains(plane, points, tolerance);
    }
    kernels.tilted_closest_points(group_);
    for (std::size_t k = 0; k < count; ++k) {
      closest[first + k].reset();
      if (found[k]) closest[first + k] = group_.closest_point(static_cast<int>(k));
    }
  }
}

}  // namespace sulcus
