#include "engine/normals/filled_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "engine/normals/ldm_tuning.hpp"
#include "engine/normals/quadric_filter.hpp"

namespace sulcus {

namespace {

constexpr float kPerPart = 1.0f / kHeightParts;

/// The nearest point of a quadric to the origin, in its own units: by three steps of Newton's from
/// the point above the origin. One, as quantised heights are worth, errs by 0.1 degrees where the
/// surface bends by 1 / 12 a voxel.
ClosestPoint nearest_of(const Quadric& c) {
  float x = 0.0f, y = 0.0f, z = 0.0f, slope_x = 0.0f, slope_y = 0.0f;
  const auto look = [&] {
    z = c[0] + (c[1] * x + c[2] * y) + ((c[3] * x * x + c[5] * y * y) + c[4] * (x * y));
    slope_x = c[1] + (2.0f * c[3] * x + c[4] * y);
    slope_y = c[2] + (c[4] * x + 2.0f * c[5] * y);
  };
  look();
  for (int step = 0; step < 3; ++step) {
    const float out =
        (z - (slope_x * x + slope_y * y)) / (1.0f + (slope_x * slope_x + slope_y * slope_y));
    x = -slope_x * out;
    y = -slope_y * out;
    look();
  }
  const float shrink = 1.0f / std::sqrt(1.0f + (slope_x * slope_x + slope_y * slope_y));
  return {-slope_x * shrink, -slope_y * shrink, shrink, (z - (slope_x * x + slope_y * y)) * shrink};
}

/// With what fills up the last sixteen.
void copy_points(const TiltedPoints& from, TiltedPoints& to) {
  const auto count = static_cast<std::size_t>(from.count + TiltedPoints::kTogether);
  std::copy_n(from.u, count, to.u);
  std::copy_n(from.w, count, to.w);
  std::copy_n(from.n, count, to.n);
  std::copy_n(from.weight, count, to.weight);
  to.count = from.count;
}

}  // namespace

std::optional<FilledPoint> fit_whole_filled(const FilledMap& map, float tolerance) noexcept {
  if (!map.whole() || map.ns < 2) return {};
  const QuadricFilter& filter = quadric_filter(map.ns, map.lanes);
  const MapKernels& kernels = map_kernels();
  std::array<std::int64_t, kQuadric> sums;
  kernels.filled_sums(map, filter, sums.data());
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
  const float left = kernels.filled_residual(map, surface) * cosine;
  if (!(left <= tolerance)) return {};
  // A column's mean height is above that at its middle by 1/24 of the second derivatives.
  surface.c[0] -= (surface.c[3] + surface.c[5]) * (1.0f / 12.0f);
  return FilledPoint{closest_point_of(surface), left};
}

float height_noise(const FilledMap& map, float least) noexcept {
  // Third differences of noise of variance s^2 have 20 s^2; the median of a bell is 0.67 s.
  constexpr float kPerMedian = 1.0f / (4.4721360f * 0.6744898f);
  std::array<int, 256> sizes;
  std::size_t count = 0;
  const auto add = [&](int i, int j, int di, int dj) {
    const std::array<int, 4> h{map.at(i, j), map.at(i + di, j + dj), map.at(i + 2 * di, j + 2 * dj),
                               map.at(i + 3 * di, j + 3 * dj)};
    if (std::ranges::find(h, int{FilledMap::kNone}) != h.end() || count == sizes.size()) return;
    sizes[count++] = std::abs((h[3] - h[0]) - 3 * (h[2] - h[1]));
  };
  const int ns = std::min(map.ns, 6);
  for (int across = -ns; across <= ns; across += 2) {
    for (int along = -ns; along + 3 <= ns; ++along) {
      add(along, across, 1, 0);
      add(across, along, 0, 1);
    }
  }
  if (count < 8) return 0.0f;
  // Mostly there is none: to count is quicker than to sort.
  const auto bound = static_cast<int>(least * static_cast<float>(kHeightParts) / kPerMedian);
  const auto above =
      std::count_if(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](int size) { return size > bound; });
  if (2 * static_cast<std::size_t>(above) < count) return 0.0f;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(sizes.begin(), middle, sizes.begin() + static_cast<std::ptrdiff_t>(count));
  return static_cast<float>(*middle) * kPerPart * kPerMedian;
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
  map_kernels().gather_filled(map, frame_, all_);
}

/// In map space and voxels, of a quadric in the frame in units of its radius.
FilledPoint FilledFitter::nearest_on(const Quadric& c, float residual_of_fit) const noexcept {
  const TiltedFrame& f = frame_;
  const ClosestPoint p = nearest_of(c);
  const auto along = [&](std::size_t a) {
    return p.normal_x * f.u[a] + p.normal_y * f.w[a] + p.normal_z * f.n[a];
  };
  return {{along(0), along(1), along(2), p.offset * f.radius}, residual_of_fit};
}

float FilledFitter::residual(const Quadric& quadric, const TiltedPoints& points) const noexcept {
  Residuals residuals;
  map_kernels().residuals(points, quadric, residuals);
  return residuals.largest * frame_.radius;
}

std::optional<FilledPoint> FilledFitter::fit_ball(float tolerance) noexcept {
  if (all_.count < kFewestPointsInBall) return {};
  const MapKernels& kernels = map_kernels();
  TiltedMoments moments;
  kernels.moments(all_, moments);
  group_.put_frame(0, frame_);
  group_.put_moments(0, moments);
  kernels.solve_points(group_);
  if (group_.has_quadric[0] == 0) return {};
  const Quadric surface = group_.quadric_at(0);
  const float left = residual(surface, all_);
  if (!(left <= tolerance)) return {};
  return nearest_on(surface, left);
}

void FilledFitter::fit_sides(std::span<const MapSide> sides, float tolerance,
                             std::span<SideFit> fits) noexcept {
  const MapKernels& kernels = map_kernels();
  const TiltedFrame& f = frame_;
  std::array<SidePoints, TiltedGroup::kSize> taken;
  for (TiltedPoints& points : std::span(of_sides_).first(std::min(taken.size(), sides.size()))) {
    copy_points(all_, points);
  }
  for (std::size_t first = 0; first < sides.size(); first += taken.size()) {
    const std::size_t count = std::min(taken.size(), sides.size() - first);
    TiltedMoments moments;
    for (std::size_t k = 0; k < count; ++k) {
      const MapSide& side = sides[first + k];
      const std::array<float, 3> across{side.x * f.u[0] + side.y * f.u[1],
                                        side.x * f.w[0] + side.y * f.w[1],
                                        side.x * f.n[0] + side.y * f.n[1]};
      taken[k] = kernels.take_side(all_, across, -side.behind / f.radius, of_sides_[k].weight);
      taken[k].width *= f.radius;
      kernels.moments(of_sides_[k], moments);
      group_.put_frame(static_cast<int>(k), frame_);
      group_.put_moments(static_cast<int>(k), moments);
    }
    kernels.solve_points(group_);
    for (std::size_t k = 0; k < count; ++k) {
      const TiltedPoints& points = of_sides_[k];
      SideFit& fit = fits[first + k];
      fit.explains = SideFit::Explains::kNothing;
      float least = kNearlyExplained;
      const auto take = [&](const Quadric& surface) {
        const float left = residual(surface, points);
        if (!(left <= least)) return;
        least = left;
        fit = {left <= tolerance ? SideFit::Explains::kAll : SideFit::Explains::kNearly,
               nearest_on(surface, left)};
      };
      if (group_.has_quadric[k] != 0 && taken[k].count >= kFewestPointsInBall &&
          taken[k].width >= kLeastQuadricWidth) {
        take(group_.quadric_at(static_cast<int>(k)));
      }
      if (fit.explains != SideFit::Explains::kAll && group_.has_plane[k] != 0 &&
          taken[k].count >= kFewestPointsOnSide && taken[k].width >= kLeastPlaneWidth) {
        take({group_.plane[0][k], group_.plane[1][k], group_.plane[2][k]});
      }
    }
  }
}

}  // namespace sulcus
