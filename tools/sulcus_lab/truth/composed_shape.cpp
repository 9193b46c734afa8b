#include "tools/sulcus_lab/truth/composed_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr double kLeastGradient2 = 0.25;  // of a side's, which is 1 where it is a distance

/// The nearest point of one side to p: onto it by Newton steps along the gradient, then along it
/// towards p, in turn. For a true distance one round is exact.
Vector3d nearest_on(const Side& side, const Vector3d& p) {
  Vector3d x = p;
  for (int round = 0; round < 30; ++round) {
    for (int newton = 0; newton < 3; ++newton) {
      const Vector3d g = side.gradient(x);
      // Where sides blend the gradient may nearly vanish; the step is held then.
      x -= side.value(x) / std::max(g.squaredNorm(), kLeastGradient2) * g;
    }
    const Vector3d n = side.gradient(x).normalized();
    const Vector3d along = (p - x) - (p - x).dot(n) * n;
    if (along.norm() < 1e-4 * (p - x).norm() + 1e-12) break;
    x += along;
  }
  return x;
}

/// The nearest point to x where two sides meet, by Gauss-Newton steps of least length; none where
/// they run side by side.
std::optional<Vector3d> nearest_on_both(const Side& a, const Side& b, Vector3d x) {
  double least = 0.0;
  for (int step = 0; step < 20; ++step) {
    const Vector3d ga = a.gradient(x), gb = b.gradient(x);
    Eigen::Matrix2d gram;
    gram << ga.dot(ga), ga.dot(gb), ga.dot(gb), gb.dot(gb);
    if (!(gram.determinant() >= 1e-4 * gram(0, 0) * gram(1, 1))) return std::nullopt;
    const Eigen::Vector2d residual(a.value(x), b.value(x));
    if (step == 0) least = residual.norm();
    // The steps lead away: there is no such point near here.
    if (!(residual.norm() <= 4.0 * least + 1e-12)) return std::nullopt;
    least = std::min(least, residual.norm());
    const Eigen::Vector2d s = gram.inverse() * residual;
    const Vector3d change = s.x() * ga + s.y() * gb;
    x -= change;
    if (change.norm() < 1e-9 * (1.0 + x.norm())) break;
  }
  return x;
}

}  // namespace

Side half_space(const Vector3d& point, const Vector3d& normal) {
  return {[=](const Vector3d& p) { return normal.dot(p - point); },
          [=](const Vector3d&) { return normal; }, 1.0, "face"};
}

Side outside_capsule(const Vector3d& a, const Vector3d& b, double radius, std::string zone) {
  const auto from_axis = [=](const Vector3d& p) -> Vector3d {
    const Vector3d along = b - a;
    const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return p - (a + t * along);
  };
  return {[=](const Vector3d& p) { return radius - from_axis(p).norm(); },
          [=](const Vector3d& p) -> Vector3d {
            const Vector3d d = from_axis(p);
            const double length = d.norm();
            return length > 0.0 ? Vector3d(-d / length) : Vector3d(Vector3d::UnitZ());
          },
          1.0, std::move(zone)};
}

ComposedShape::ComposedShape(std::vector<Side> sides, const Eigen::AlignedBox3d& bounds)
    : sides_(std::move(sides)), bounds_(bounds) {
  for (const Side& side : sides_) lipschitz_ = std::max(lipschitz_, side.lipschitz);
}

std::size_t ComposedShape::outermost(const Vector3d& p) const {
  std::size_t best = 0;
  double greatest = -std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < sides_.size(); ++s) {
    const double value = sides_[s].value(p);
    if (value > greatest) {
      greatest = value;
      best = s;
    }
  }
  return best;
}

double ComposedShape::value(const Vector3d& p) const {
  double greatest = -std::numeric_limits<double>::infinity();
  for (const Side& side : sides_) greatest = std::max(greatest, side.value(p));
  return greatest;
}

Vector3d ComposedShape::gradient(const Vector3d& p) const {
  return sides_[outermost(p)].gradient(p);
}

ComposedShape::ClosestPoint ComposedShape::closest_point(const Vector3d& p) const {
  ClosestPoint best{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < sides_.size(); ++s) {
    const Side& side = sides_[s];
    if (std::abs(side.value(p)) >= least * side.lipschitz) continue;  // further away than the best
    const Vector3d x = nearest_on(side, p);
    const double distance = (x - p).norm();
    if (distance >= least) continue;
    least = distance;
    best = {x, side.gradient(x).normalized(), s};
  }
  return best;
}

std::optional<double> ComposedShape::edge_distance(const ClosestPoint& closest,
                                                   double reach) const {
  std::optional<double> least;
  for (std::size_t s = 0; s < sides_.size(); ++s) {
    if (s == closest.side ||
        std::abs(sides_[s].value(closest.point)) > reach * sides_[s].lipschitz) {
      continue;
    }
    const std::optional<Vector3d> edge =
        nearest_on_both(sides_[closest.side], sides_[s], closest.point);
    // Where a third side has taken the curve away there is no edge.
    if (!edge || value(*edge) > 1e-3 * reach) continue;
    const double distance = (*edge - closest.point).norm();
    if (distance <= reach && (!least || distance < *least)) least = distance;
  }
  return least;
}

}  // namespace sulcus::lab
