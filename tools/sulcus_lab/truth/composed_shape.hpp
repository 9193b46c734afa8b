#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/shapes/basic_shapes.hpp"

namespace sulcus::lab {

using ScalarField = std::function<double(const Eigen::Vector3d&)>;
using VectorField = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// One smooth side of a solid: an implicit function, negative inside, and its gradient; see
/// ImplicitShape.
struct Side {
  ScalarField value;
  VectorField gradient;
  double lipschitz = 1.0;
  std::string zone = "face";  // of what lies on it, away from the edges
};

/// A whole shape as one side.
template <ImplicitShape S>
Side side_of(const S& shape, std::string zone = "face") {
  return {[shape](const Eigen::Vector3d& p) { return shape.value(p); },
          [shape](const Eigen::Vector3d& p) { return Eigen::Vector3d(shape.gradient(p)); },
          shape.lipschitz(), std::move(zone)};
}
/// What lies under the plane through `point` with the outward unit normal.
Side half_space(const Eigen::Vector3d& point, const Eigen::Vector3d& normal);
/// What lies outside the segment from a to b thickened by `radius`: a sweep of a ball cut out.
Side outside_capsule(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius,
                     std::string zone = "face");

/// What several sides have in common. It is an ImplicitShape, and the nearest point of its surface
/// is known from inside: the complement is the union of the sides' complements, so it is the
/// nearest of the sides' own nearest points, whatever the edges look like.
class ComposedShape : public OnePartShape {
 public:
  /// One side at least; lengths in one unit throughout, which is the caller's choice.
  ComposedShape(std::vector<Side> sides, const Eigen::AlignedBox3d& bounds);

  double value(const Eigen::Vector3d& p) const;
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const;
  double lipschitz() const { return lipschitz_; }
  Eigen::AlignedBox3d bounds() const { return bounds_; }

  const std::vector<Side>& sides() const { return sides_; }

  struct ClosestPoint {
    Eigen::Vector3d point, normal;  // on the surface; outward, unit
    std::size_t side;
  };
  /// The nearest point of the surface to a point inside.
  ClosestPoint closest_point(const Eigen::Vector3d& p) const;

  /// How far the nearest edge is from a closest point, where it is within `reach`.
  std::optional<double> edge_distance(const ClosestPoint& closest, double reach) const;

 private:
  std::size_t outermost(const Eigen::Vector3d& p) const;

  std::vector<Side> sides_;
  Eigen::AlignedBox3d bounds_;
  double lipschitz_ = 0.0;
};

}  // namespace sulcus::lab
