#pragma once

#include <optional>

#include <Eigen/Core>

#include "engine/volume/workpiece.hpp"

namespace sulcus::lab {

/// How full the solid is at a point: the voxels' centres, 1 where solid and 0 where not,
/// trilinearly interpolated. It is 1/2 at the middle between a solid and an empty centre, which is
/// where a voxel's face lies, and 0 outside the grid.
double occupancy_at(const Workpiece& workpiece, const Eigen::Vector3d& p_index) noexcept;

/// The method that programs built on CHAI3D use, to compare with: the tool is one point, and the
/// force pulls the device to a proxy, or god object, which follows it but never enters the solid
/// [Zilles and Salisbury 1995; Ruspini et al. 1997]. The solid's surface is where occupancy_at is
/// 1/2.
///
/// A move goes as in CHAI3D's cAlgorithmFingerProxy, without friction: straight to the goal, or to
/// where the surface is first met; then in the surface's tangent plane to the point nearest the
/// goal, or to where the surface is met again; then along the line in which the two tangent planes
/// cut, or to where it is met a third time. What is left is for the next tick. Where a proxy is
/// stopped it is held 0.05 voxels off the surface, so that the next way along it is free, and it
/// never goes further from a goal than it stands.
///
/// It departs from CHAI3D in what the surface of voxels is: there each voxel is a ball, and a
/// segment is tested against them every two voxels; here it is the smoother surface above, and its
/// normal the gradient over a voxel. Even so a plane that is tilted against the grid keeps its
/// steps, and the proxy stays at one until the device has gone past it by up to twice its depth:
/// the force turns by up to 65 degrees. More slides in a tick do not help: the steps are the
/// surface's own.
class PointProxy {
 public:
  PointProxy(const Workpiece& workpiece, double stiffness_N_per_m)
      : workpiece_(workpiece), stiffness_(stiffness_N_per_m) {}

  /// Moves the proxy towards the goal, world, m, and returns where it is. The first goal outside
  /// the solid places it; until then it is where the goal is and holds nothing. (Voxels are only
  /// ever removed, so it stays outside.) A goal that is not finite, or over a kilometre away, moves
  /// nothing and is answered with no force; the scene's origin is returned where there was no goal
  /// before it. Cost: the voxels on the way, at most the grid's diagonal, three times; 0.13 ms at
  /// the most that was seen for jumps across 512 voxels each way.
  Eigen::Vector3d move(const Eigen::Vector3d& goal_world) noexcept;

  /// Of the last move, for the device, N: stiffness times the way from the goal to the proxy.
  const Eigen::Vector3d& force_N() const noexcept { return force_; }
  bool placed() const noexcept { return proxy_index_.has_value(); }

 private:
  struct Way {
    Eigen::Vector3d end_index;
    bool met = false;  // the surface, at its end
  };
  Way go(const Eigen::Vector3d& from_index, const Eigen::Vector3d& to_index) const noexcept;
  bool is_solid(const Eigen::Vector3d& p_index) const noexcept;
  std::optional<Eigen::Vector3d> outward_normal(const Eigen::Vector3d& p_index) const noexcept;
  Eigen::Vector3d held_off(const Eigen::Vector3d& p_index,
                           const Eigen::Vector3d& normal) const noexcept;
  Eigen::Vector3d slide(const Eigen::Vector3d& met_index,
                        const Eigen::Vector3d& goal_index) const noexcept;

  const Workpiece& workpiece_;
  double stiffness_;
  std::optional<Eigen::Vector3d> proxy_index_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
};

}  // namespace sulcus::lab
