#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sulcus {

/// A rigid pose, "A from B": points by `point`, directions by `direction`. (A gradient of a
/// function of B turns like a direction, since the pose is rigid.) The quaternion is unit length.
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m, of B's origin in A
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // A from B

  Eigen::Vector3d point(const Eigen::Vector3d& p) const { return position + orientation * p; }
  Eigen::Vector3d direction(const Eigen::Vector3d& d) const { return orientation * d; }
  Eigen::Vector3d inverse_point(const Eigen::Vector3d& p) const {
    return orientation.conjugate() * (p - position);
  }
  Eigen::Vector3d inverse_direction(const Eigen::Vector3d& d) const {
    return orientation.conjugate() * d;
  }
};

/// A from C, of A from B and B from C.
inline Pose operator*(const Pose& a, const Pose& b) {
  return {a.point(b.position), a.orientation * b.orientation};
}
/// B from A, of A from B.
inline Pose inverse(const Pose& pose) {
  return {pose.orientation.conjugate() * -pose.position, pose.orientation.conjugate()};
}

/// As files have one: position, and orientation (w, x, y, z).
inline Pose pose_of(const double (&position)[3], const double (&orientation)[4]) {
  const double* q = orientation;
  return {{position[0], position[1], position[2]}, Eigen::Quaterniond(q[0], q[1], q[2], q[3])};
}

/// Turns about x, then y, then z, axes that stay; rad.
inline Eigen::Quaterniond rotation_xyz(const Eigen::Vector3d& angles) {
  return Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
}

}  // namespace sulcus
