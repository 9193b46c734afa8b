#include "engine/graphics/sight.hpp"

#include <algorithm>
#include <cstddef>

namespace sulcus {
namespace {

/// Whether the way from `from` to `to` meets a box: what is left of it between each two planes.
bool meets(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::AlignedBox3d& box) {
  double enter = 0.0;
  double leave = 1.0;
  for (int a = 0; a < 3; ++a) {
    const double way = to[a] - from[a];
    if (way == 0.0) {
      if (from[a] < box.min()[a] || from[a] > box.max()[a]) return false;
      continue;
    }
    const double at_min = (box.min()[a] - from[a]) / way;
    const double at_max = (box.max()[a] - from[a]) / way;
    enter = std::max(enter, std::min(at_min, at_max));
    leave = std::min(leave, std::max(at_min, at_max));
  }
  return enter <= leave;
}

}  // namespace

std::vector<Eigen::Vector3d> points_to_see(const Viewpoint& from,
                                           std::span<const Eigen::AlignedBox3d> solid_world,
                                           const Eigen::Vector3d& tip_world) {
  if (from.follows_burr) return {tip_world};
  Eigen::AlignedBox3d whole;
  for (const Eigen::AlignedBox3d& box : solid_world) whole.extend(box);
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::AlignedBox3d& box : solid_world) {
    const Eigen::Vector3d middle = box.center();
    if (middle.z() < whole.center().z()) continue;
    // A third of the width apart: none at the box's edges, where a rounded body has nothing.
    const Eigen::Vector3d step = box.sizes() / 3.0;
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        points.push_back(middle + Eigen::Vector3d(x * step.x(), y * step.y(), 0.0));
      }
    }
  }
  return points;
}

double hidden_share(const Eigen::Vector3d& eye_world, std::span<const Eigen::Vector3d> points_world,
                    std::span<const Eigen::AlignedBox3d> boxes_grid, const Pose& world_from_grid) {
  if (points_world.empty()) return 0.0;
  Eigen::AlignedBox3d whole;
  for (const Eigen::AlignedBox3d& box : boxes_grid) whole.extend(box);
  const Eigen::Vector3d eye = world_from_grid.inverse_point(eye_world);
  std::size_t hidden = 0;
  for (const Eigen::Vector3d& point_world : points_world) {
    const Eigen::Vector3d point = world_from_grid.inverse_point(point_world);
    if (!meets(eye, point, whole)) continue;
    bool before = false;
    bool around = false;
    for (const Eigen::AlignedBox3d& box : boxes_grid) {
      before = before || meets(eye, point, box);
      around = around || box.contains(point);
    }
    hidden += before && !around ? 1u : 0u;
  }
  return static_cast<double>(hidden) / static_cast<double>(points_world.size());
}

}  // namespace sulcus
