#include "engine/shapes/basic_shapes.hpp"

#include <algorithm>
#include <cmath>

namespace sulcus {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d SphereShape::gradient(const Vector3d& p) const {
  const double length = p.norm();
  return length > 0.0 ? Vector3d(p / length) : Vector3d(Vector3d::UnitZ());
}

AlignedBox3d SphereShape::bounds() const {
  return {Vector3d::Constant(-radius_), Vector3d::Constant(radius_)};
}

double BoxShape::value(const Vector3d& p) const {
  const Vector3d beyond = p.cwiseAbs() - half_;
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

Vector3d BoxShape::gradient(const Vector3d& p) const {
  const Vector3d beyond = p.cwiseAbs() - half_;
  const Vector3d sign(std::copysign(1.0, p.x()), std::copysign(1.0, p.y()),
                      std::copysign(1.0, p.z()));
  const Vector3d outside = beyond.cwiseMax(0.0);
  const double distance = outside.norm();
  if (distance > 0.0) return outside.cwiseProduct(sign) / distance;
  Eigen::Index face = 0;
  beyond.maxCoeff(&face);
  return sign[face] * Vector3d::Unit(face);
}

PlateShape::PlateShape(double thickness_m, double tilt)
    : half_(0.5 * thickness_m), normal_(std::sin(tilt), 0.0, std::cos(tilt)) {}

double PlateShape::value(const Vector3d& p) const { return std::abs(normal_.dot(p)) - half_; }

Vector3d PlateShape::gradient(const Vector3d& p) const {
  return std::copysign(1.0, normal_.dot(p)) * normal_;
}

AlignedBox3d PlateShape::bounds() const {
  AlignedBox3d box(Vector3d(-half_ * normal_));
  return box.extend(Vector3d(half_ * normal_));
}

double TorusShape::value(const Vector3d& p) const {
  return std::hypot(std::hypot(p.x(), p.y()) - major_, p.z()) - minor_;
}

Vector3d TorusShape::gradient(const Vector3d& p) const {
  const double ring = std::hypot(p.x(), p.y());
  const Vector2d radial = ring > 0.0 ? Vector2d(p.head<2>() / ring) : Vector2d(Vector2d::UnitX());
  const Vector2d from_circle(ring - major_, p.z());  // (radial, z)
  const double length = from_circle.norm();
  if (length == 0.0) return Vector3d::UnitZ();
  const Vector2d along = from_circle / length;
  return {along.x() * radial.x(), along.x() * radial.y(), along.y()};
}

AlignedBox3d TorusShape::bounds() const {
  const Vector3d half(major_ + minor_, major_ + minor_, minor_);
  return {-half, half};
}

GrooveShape::GrooveShape(double angle, double depth_m)
    : depth_(depth_m),
      half_width_(depth_m * std::tan(0.5 * angle)),
      wall_(std::sin(0.5 * angle), std::cos(0.5 * angle)) {}

// By symmetry in the half plane y >= 0, whose surface is the wall from the bottom edge (0, -depth)
// to the rim (half_width, 0), and the flat face from there outward.
GrooveShape::Nearest GrooveShape::nearest(const Vector3d& p) const {
  const double side = std::copysign(1.0, p.y());
  const Vector2d q(std::abs(p.y()), p.z());
  const Vector2d bottom(0.0, -depth_), rim(half_width_, 0.0);
  const Vector2d wall_normal(-wall_.y(), wall_.x());  // out of the solid, into the groove

  const double along = wall_.dot(q - bottom);
  const double above_wall = wall_normal.dot(q - bottom);
  const double length = (rim - bottom).norm();
  const Vector2d on_wall = bottom + std::clamp(along, 0.0, length) * wall_;
  const Vector2d on_face(std::max(q.x(), half_width_), 0.0);
  const bool solid = q.y() <= 0.0 && above_wall <= 0.0;

  const double to_wall = (q - on_wall).norm(), to_face = (q - on_face).norm();
  const Vector2d foot = to_wall < to_face ? on_wall : on_face;
  const double distance = std::min(to_wall, to_face);
  Vector2d outward = Vector2d::UnitY();
  const bool on_the_face = to_face <= to_wall && q.x() > half_width_;
  if (to_wall < to_face && along > 0.0 && along < length) {
    outward = wall_normal;
  } else if (!on_the_face && distance > 0.0) {
    outward = (solid ? -1.0 : 1.0) * (q - foot) / distance;  // an edge is nearest
  }
  return {solid ? -distance : distance, {side * outward.x(), outward.y()}};
}

double GrooveShape::value(const Vector3d& p) const { return nearest(p).distance; }

Vector3d GrooveShape::gradient(const Vector3d& p) const {
  const Vector2d outward = nearest(p).outward;
  return {0.0, outward.x(), outward.y()};
}

AlignedBox3d GrooveShape::bounds() const { return {Vector3d(0.0, 0.0, -depth_), Vector3d::Zero()}; }

}  // namespace sulcus
