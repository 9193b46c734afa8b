#include "engine/normals/tilted_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "engine/normals/grown_plane.hpp"
#include "engine/normals/ldm_tuning.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

using Eigen::Vector3f;

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

/// Of a quadric, the largest deviation from its tangent plane at the ball's rim.
float sagitta_of(const Quadric& c) {
  const float mean = 0.5f * (c[3] + c[5]), half = 0.5f * (c[3] - c[5]), twist = 0.5f * c[4];
  return std::abs(mean) + std::sqrt(half * half + twist * twist);
}

Residuals residuals_of(const Quadric& c, const TiltedPoints& points) {
  Residuals residuals;
  map_kernels().residuals(points, c, residuals);
  return residuals;
}

bool are_explained(const Residuals& residuals, const TiltedPoints& points, const TiltedFrame& frame,
                   const ResidualTolerance& tolerance) {
  const float cosine = frame.n[2];
  const float mean_square =
      tolerance.rms_by_cosine * std::max(cosine, kLeastPlaneCosine) / frame.radius;
  return residuals.largest * frame.radius <= tolerance.beyond_half_cosine + 0.5f * cosine &&
         residuals.sum_squares <= static_cast<float>(points.count) * mean_square * mean_square;
}

}  // namespace

std::optional<ClosestPoint> close_plane(const HeightMap& map) noexcept {
  PlaneSums sums;
  map_kernels().close_sums(map, sums);
  if (sums.n < kFewestClose) return {};
  const std::optional<PlaneSolution> twice = solve_plane(sums);
  if (!twice) return {};
  const float slope_x = 0.5f * twice->c1, slope_y = 0.5f * twice->c2;
  const float cosine = 1.0f / std::sqrt(1.0f + (slope_x * slope_x + slope_y * slope_y));
  return ClosestPoint{-slope_x * cosine, -slope_y * cosine, cosine, 0.5f * twice->c0 * cosine};
}

void TiltedFitter::gather(std::span<const TiltedFit> fits) noexcept {
  const MapKernels& kernels = map_kernels();
  TiltedMoments moments;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    frames_[k] = frame_of(fits[k].normal, fits[k].radius, fits[k].side);
    kernels.gather(*fits[k].map, frames_[k], points_[k]);
    kernels.moments(points_[k], moments);
    group_.put_frame(static_cast<int>(k), frames_[k]);
    group_.put_moments(static_cast<int>(k), moments);
  }
}

TiltedFitter::Found TiltedFitter::judge(std::size_t k, float& scatter) noexcept {
  const auto lane = static_cast<int>(k);
  const TiltedPoints& points = points_[k];
  scatter = std::numeric_limits<float>::infinity();
  if (points.count < kFewestPointsInBall || group_.has_quadric[k] == 0) return Found::kNothing;
  const Residuals of_quadric = residuals_of(group_.quadric_at(lane), points);
  if (!are_explained(of_quadric, points, frames_[k], kQuadricInBall)) {
    const float radius = frames_[k].radius;
    scatter = of_quadric.sum_squares * (radius * radius) /
              static_cast<float>(points.count - static_cast<int>(kQuadric));
    return Found::kNothing;
  }
  const Quadric plane{group_.plane[0][k], group_.plane[1][k], group_.plane[2][k]};
  if (group_.has_plane[k] == 0 ||
      !are_explained(residuals_of(plane, points), points, frames_[k], kPlaneInBall)) {
    return Found::kCurved;
  }
  group_.put_quadric(lane, plane);
  return Found::kFlat;
}

/// A step of Newton's towards the least sum of fourth powers: what quantisation leaves is spread
/// evenly up to a bound, so that the points near to it say most (see grow_plane).
void TiltedFitter::sharpen(std::span<const Found> found) noexcept {
  if (std::ranges::count(found, Found::kCurved) == 0) return;
  const MapKernels& kernels = map_kernels();
  TiltedMoments moments;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k] != Found::kCurved) continue;
    kernels.sharpen_points(group_.quadric_at(static_cast<int>(k)), points_[k]);
    kernels.moments(points_[k], moments);
    sharpened_.put_moments(static_cast<int>(k), moments);
  }
  kernels.solve_sharpened(sharpened_);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k] != Found::kCurved || sharpened_.has_quadric[k] == 0) continue;
    for (std::size_t f = 0; f < kQuadric; ++f) {
      group_.quadric[f][k] += sharpened_.quadric[f][k] * (1.0f / 3.0f);
    }
  }
}

void TiltedFitter::fit(std::span<TiltedFit> fits) noexcept {
  for (std::size_t first = 0; first < fits.size(); first += points_.size()) {
    fit_group(fits.subspan(first, std::min(points_.size(), fits.size() - first)));
  }
}

void TiltedFitter::fit_group(std::span<TiltedFit> fits) noexcept {
  gather(fits);
  map_kernels().solve_quantised(group_);
  std::array<Found, TiltedGroup::kSize> found{};
  for (std::size_t k = 0; k < fits.size(); ++k) found[k] = judge(k, fits[k].scatter);
  sharpen(std::span(found).first(fits.size()));
  map_kernels().tilted_closest_points(group_);
  for (std::size_t k = 0; k < fits.size(); ++k) {
    TiltedFit& fit = fits[k];
    fit.closest.reset();
    if (found[k] == Found::kNothing) {
      fit.sagitta = sagitta_of(group_.quadric_at(static_cast<int>(k))) * fit.radius;
      fit.unexplained = group_.closest_point(static_cast<int>(k));
      continue;
    }
    fit.closest = group_.closest_point(static_cast<int>(k));
    if (found[k] != Found::kFlat) continue;
    const auto least = static_cast<int>(kLeastShareGrown * static_cast<float>(points_[k].count));
    if (const auto face = grow_plane(*fit.map, *fit.closest, least, PlaneStart::kFit))
      fit.closest = face;
  }
}

}  // namespace sulcus
