#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/shapes/implicit_shape.hpp"

namespace sulcus {

// The simple test bodies: exact signed distances in metres, in their own space, whose origin is the
// centre of the scene. All are of one part, kEnamel. Sizes must be positive and finite (the scene
// loader checks them). Where the nearest surface point is not unique (the medial axis) the gradient
// is that of one of the nearest points. Infinite bodies (plate, groove) give bounds of no extent
// along the directions in which they never end, so that no grid counts as having clipped them.

/// What every shape of one part has in common: its value is a true distance.
struct OnePartShape {
  double lipschitz() const { return 1.0; }
  PartSet parts_within(const Eigen::Vector3d&, double, PartSet) const {
    return PartSet::only(Part::kEnamel);
  }
};

/// A ball about the origin.
class SphereShape : public OnePartShape {
 public:
  explicit SphereShape(double radius_m) : radius_(radius_m) {}
  double value(const Eigen::Vector3d& p) const { return p.norm() - radius_; }
  /// +z at the centre.
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const;
  Eigen::AlignedBox3d bounds() const;

 private:
  double radius_;
};

/// An upright box about the origin.
class BoxShape : public OnePartShape {
 public:
  explicit BoxShape(const Eigen::Vector3d& size_m) : half_(0.5 * size_m) {}
  double value(const Eigen::Vector3d& p) const;
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const;
  Eigen::AlignedBox3d bounds() const { return {-half_, half_}; }

 private:
  Eigen::Vector3d half_;
};

/// An endless plate through the origin, its normal +z turned by `tilt` (rad) about +y.
class PlateShape : public OnePartShape {
 public:
  PlateShape(double thickness_m, double tilt);
  double value(const Eigen::Vector3d& p) const;
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const;
  /// The plate along its normal only: the segment from one face to the other.
  Eigen::AlignedBox3d bounds() const;

 private:
  double half_;
  Eigen::Vector3d normal_;
};

/// A ring about the z axis: the circle of radius `major` in z = 0, thickened by `minor` < major.
class TorusShape : public OnePartShape {
 public:
  TorusShape(double major_m, double minor_m) : major_(major_m), minor_(minor_m) {}
  double value(const Eigen::Vector3d& p) const;
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const;
  Eigen::AlignedBox3d bounds() const;

 private:
  double major_, minor_;
};

/// An endless block below z = 0 with a V groove along x in its face: opening angle `angle` (rad, 0
/// to pi), its bottom edge at y = 0, z = -depth.
class GrooveShape : public OnePartShape {
 public:
  GrooveShape(double angle, double depth_m);
  double value(const Eigen::Vector3d& p) const;
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const;
  /// The depth of the groove, from -depth to 0, on the z axis.
  Eigen::AlignedBox3d bounds() const;

 private:
  struct Nearest {
    double distance;          // signed
    Eigen::Vector2d outward;  // unit, (y, z)
  };
  Nearest nearest(const Eigen::Vector3d& p) const;

  double depth_, half_width_;
  Eigen::Vector2d wall_;  // unit, from the bottom edge up the wall at y > 0
};

}  // namespace sulcus
