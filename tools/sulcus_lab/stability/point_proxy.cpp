#include "tools/sulcus_lab/stability/point_proxy.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace sulcus::lab {

namespace {

// All lengths in voxels.
constexpr double kMarchStep = 0.25;    // of a march: a wall of one voxel is met four times
constexpr double kFoundWithin = 1e-4;  // where the surface is met
constexpr double kHeldOff = 0.05;      // from the surface; 1.7 um at the paper's voxel
constexpr double kSpan = 0.5;          // of the central differences, to each side
constexpr double kFlat = 1e-6;         // a gradient, or a sine, that gives no direction

constexpr double kFurthest_m = 1e3;  // of a goal; beyond it points are not told apart finely enough

/// The part of the segment from + t (to - from), t in [0, 1], in which occupancy can be other than
/// 0: the grid's centres and a voxel around them. Empty where first > last.
struct Stretch {
  double first = 0.0, last = 1.0;
};

Stretch within_grid(const VoxelGrid& grid, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Stretch stretch;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = -1.0, high = grid.cells[axis];
    const double way = to[axis] - from[axis];
    if (way == 0.0) {
      if (from[axis] < low || from[axis] > high) return {1.0, 0.0};
      continue;
    }
    const double a = (low - from[axis]) / way, b = (high - from[axis]) / way;
    stretch.first = std::max(stretch.first, std::min(a, b));
    stretch.last = std::min(stretch.last, std::max(a, b));
  }
  return stretch;
}

}  // namespace

double occupancy_at(const Workpiece& workpiece, const Eigen::Vector3d& p_index) noexcept {
  const Eigen::Vector3i& cells = workpiece.grid().cells;
  // Before it becomes a cell, which could not hold what is far away.
  if (!((p_index.array() > -1.0).all() && (p_index.array() < cells.cast<double>().array()).all())) {
    return 0.0;
  }
  const Cell lower = p_index.array().floor().cast<int>();
  const Eigen::Vector3d t = p_index - lower.cast<double>();
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Cell offset(corner & 1, corner >> 1 & 1, corner >> 2);
    if (!workpiece.solid(lower + offset)) continue;
    sum += (offset.x() ? t.x() : 1.0 - t.x()) * (offset.y() ? t.y() : 1.0 - t.y()) *
           (offset.z() ? t.z() : 1.0 - t.z());
  }
  return sum;
}

bool PointProxy::is_solid(const Eigen::Vector3d& p_index) const noexcept {
  return occupancy_at(workpiece_, p_index) >= 0.5;
}

/// None where the occupancy has no slope, as midway in a slit.
std::optional<Eigen::Vector3d> PointProxy::outward_normal(
    const Eigen::Vector3d& p_index) const noexcept {
  Eigen::Vector3d fall;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d h = kSpan * Eigen::Vector3d::Unit(axis);
    fall[axis] = occupancy_at(workpiece_, p_index - h) - occupancy_at(workpiece_, p_index + h);
  }
  const double length = fall.norm();
  if (length < kFlat) return std::nullopt;
  return fall / length;
}

/// Along the segment up to its end, or to the last point found free before the surface. `from` is
/// free.
PointProxy::Way PointProxy::go(const Eigen::Vector3d& from_index,
                               const Eigen::Vector3d& to_index) const noexcept {
  const Eigen::Vector3d way = to_index - from_index;
  const double length = way.norm();
  const Stretch stretch = within_grid(workpiece_.grid(), from_index, to_index);
  if (length == 0.0 || stretch.first > stretch.last) return {to_index, false};

  double free = stretch.first;
  for (double t = stretch.first; t < stretch.last;) {
    t = std::min(t + kMarchStep / length, stretch.last);
    if (!is_solid(from_index + t * way)) {
      free = t;
      continue;
    }
    double solid = t;
    while ((solid - free) * length > kFoundWithin) {
      const double middle = 0.5 * (free + solid);
      (is_solid(from_index + middle * way) ? solid : free) = middle;
    }
    return {from_index + free * way, true};
  }
  return {to_index, false};
}

/// The same point a little outward, where there is room: on the surface itself a slide would end at
/// once.
Eigen::Vector3d PointProxy::held_off(const Eigen::Vector3d& p_index,
                                     const Eigen::Vector3d& normal) const noexcept {
  const Eigen::Vector3d off = p_index + kHeldOff * normal;
  return is_solid(off) ? p_index : off;
}

/// From where the surface was met, along it towards the goal.
Eigen::Vector3d PointProxy::slide(const Eigen::Vector3d& met_index,
                                  const Eigen::Vector3d& goal_index) const noexcept {
  const std::optional<Eigen::Vector3d> first = outward_normal(met_index);
  if (!first) return met_index;
  const Eigen::Vector3d start = held_off(met_index, *first);
  const Eigen::Vector3d left = goal_index - start;
  const Way in_plane = go(start, start + left - left.dot(*first) * *first);
  if (!in_plane.met) return in_plane.end_index;

  const std::optional<Eigen::Vector3d> second = outward_normal(in_plane.end_index);
  if (!second) return in_plane.end_index;
  const Eigen::Vector3d corner = held_off(in_plane.end_index, *second);
  const Eigen::Vector3d line = first->cross(*second);
  const double sine = line.norm();
  if (sine < kFlat) return corner;
  const Eigen::Vector3d along = line / sine;
  return go(corner, corner + along.dot(goal_index - corner) * along).end_index;
}

Eigen::Vector3d PointProxy::move(const Eigen::Vector3d& goal_world) noexcept {
  force_.setZero();
  const VoxelGrid& grid = workpiece_.grid();
  // Written so that NaN fails too.
  if (!(goal_world.norm() < kFurthest_m)) {
    return proxy_index_ ? grid.world_from_index(*proxy_index_) : Eigen::Vector3d::Zero();
  }
  const Eigen::Vector3d goal = grid.index_from_world(goal_world);
  if (!proxy_index_) {
    if (!is_solid(goal)) proxy_index_ = goal;
    return goal_world;
  }
  const Way straight = go(*proxy_index_, goal);
  const Eigen::Vector3d next = straight.met ? slide(straight.end_index, goal) : goal;
  // Never further from the goal than it stood, so that under a goal at rest it comes to rest: being
  // held off and sliding back would else go on for ever over half a voxel.
  if ((next - goal).squaredNorm() < (*proxy_index_ - goal).squaredNorm()) proxy_index_ = next;
  // By what is left in voxels, so that a goal that is reached leaves exactly nothing.
  force_ = stiffness_ * grid.voxel_m * (*proxy_index_ - goal);
  return grid.world_from_index(*proxy_index_);
}

}  // namespace sulcus::lab
