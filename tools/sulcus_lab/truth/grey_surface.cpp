#include "tools/sulcus_lab/truth/grey_surface.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "engine/volume/grid.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr double kStep = 0.25;  // as a lattice four times as fine has its points

/// How the surface curves: its eigenvalues are the principal curvatures, and 0 along the normal.
Eigen::Matrix3d curvatures(const GreySpline::Sample& at) {
  const Vector3d n = at.gradient.normalized();
  const Eigen::Matrix3d along = Eigen::Matrix3d::Identity() - n * n.transpose();
  return along * at.hessian * along / at.gradient.norm();
}

double largest_curvature(const GreySpline::Sample& at) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(curvatures(at), Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseAbs()
      .maxCoeff();
}

}  // namespace

std::optional<double> GreySurface::crossing(const Vector3d& p, bool in, const Vector3d& way,
                                            double reach) const {
  double from = 0.0, to = kStep;
  while (to <= reach && solid(p + to * way) == in) {
    from = to;
    to += kStep;
  }
  if (to > reach) return std::nullopt;
  constexpr int kHalvings = 8;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (from + to);
    (solid(p + middle * way) == in ? from : to) = middle;
  }
  return 0.5 * (from + to);
}

std::optional<GreySurfacePoint> GreySurface::refined(const Vector3d& p, Vector3d x) const {
  constexpr int kRounds = 300;
  constexpr double kClose = 1e-9, kLongest = 0.25;
  for (int round = 0; round < kRounds; ++round) {
    const GreySpline::Sample at = spline_.sample(x);
    const double slope = at.gradient.norm();
    if (!(slope > 0.0)) return std::nullopt;
    const Vector3d outward = -at.gradient / slope;
    const Vector3d onto = (at.value - level_) / slope * outward;
    const Vector3d along = (p - x) - (p - x).dot(outward) * outward;
    if (onto.norm() < kClose && along.norm() < kClose) {
      return GreySurfacePoint{x, outward, (x - p).dot(outward), slope, largest_curvature(at)};
    }
    // Where the surface bends away from p, the whole of `along` leads too far.
    Vector3d step = onto + along / (1.0 + curvatures(at).norm() * (x - p).norm());
    if (step.norm() > kLongest) step *= kLongest / step.norm();
    x += step;
  }
  return std::nullopt;
}

std::optional<GreySurfacePoint> GreySurface::closest_point(const Vector3d& p) const {
  struct Start {
    double distance;
    Vector3d point;
  };
  // A place this much further away than the nearest one does not lead to a nearer point.
  constexpr double kFurther = 0.75;
  constexpr std::size_t kStarts = 4;
  const bool in = solid(p);
  double reach = kReach;
  std::vector<Start> starts;
  for_each_cell(Cell::Constant(-1), Cell::Constant(2), [&](const Cell& to) {
    if (to == Cell::Zero()) return;
    const Vector3d way = to.cast<double>().normalized();
    const std::optional<double> found = crossing(p, in, way, reach);
    if (!found) return;
    starts.push_back({*found, p + *found * way});
    reach = std::min(reach, *found + kFurther);
  });
  std::ranges::sort(starts, {}, &Start::distance);
  if (starts.size() > kStarts) starts.resize(kStarts);
  std::optional<GreySurfacePoint> best;
  for (const Start& start : starts) {
    const std::optional<GreySurfacePoint> found = refined(p, start.point);
    if (found && (!best || std::abs(found->offset) < std::abs(best->offset))) best = found;
  }
  // One that is no nearer than where the search began is of another face.
  if (best && std::abs(best->offset) > starts.front().distance + 1e-3) return std::nullopt;
  return best;
}

bool GreySurface::is_thin(const GreySurfacePoint& at, double reach) const {
  // From a little off the surface on, so that rounding is not taken for a face.
  constexpr double kOff = 0.05;
  const Vector3d inside = at.point - kOff * at.normal, outside = at.point + kOff * at.normal;
  return crossing(inside, true, -at.normal, reach) || crossing(outside, false, at.normal, reach);
}

}  // namespace sulcus::lab
