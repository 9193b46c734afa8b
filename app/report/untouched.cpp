#include "app/report/untouched.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "app/terminal/terminal.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/trajectory.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kMostTicks = 100;

std::vector<Eigen::Vector3d> surface_points(const Workpiece& workpiece) {
  const VoxelGrid& grid = workpiece.grid();
  std::vector<Eigen::Vector3d> points;
  points.reserve(workpiece.surface_voxels());
  for (std::uint32_t leaf = 0; leaf < grid.leaf_count(); ++leaf) {
    const LeafBits& surface = workpiece.surface(leaf);
    if (!any(surface)) continue;
    for_each_voxel(surface, [&](int place) {
      points.push_back(grid.centre_world(grid.leaf_origin(leaf) + cell_in_leaf(place)));
    });
  }
  return points;
}

Eigen::Vector3d vector_of(const std::array<float, 3>& v) {
  return Eigen::Vector3f(v.data()).cast<double>();
}

/// Of the nearest of the points to the capsule about the burr.
double capsule_way(const Capsule& capsule, const ChartPoint& at,
                   std::span<const Eigen::Vector3d> points) {
  const Eigen::Vector3d axis = vector_of(at.axis), tip = vector_of(at.tip_m);
  const double low = capsule.a_tool.y(), high = capsule.b_tool.y();
  double nearest2 = std::numeric_limits<double>::max();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d from_tip = p - tip;
    const double along = std::clamp(from_tip.dot(axis), low, high);
    nearest2 = std::min(nearest2, (from_tip - along * axis).squaredNorm());
  }
  return std::sqrt(nearest2) - capsule.radius_m;
}

/// The same of the burr itself, by its field, which is round about its axis or nearly so.
double burr_way(const Burr& burr, const ChartPoint& at, std::span<const Eigen::Vector3d> points) {
  const Pose tool{vector_of(at.tip_m), orientation_along(vector_of(at.axis))};
  double nearest = std::numeric_limits<double>::max();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d p_field = burr.field.field_from_tool(tool.inverse_point(p));
    nearest = std::min(nearest, static_cast<double>(burr.field.sample(p_field.cast<float>())));
  }
  return nearest;
}

}  // namespace

std::string say_untouched(const Simulation& simulation, const RunStatistics& statistics) {
  const std::vector<ChartPoint>& ticks = statistics.chart.points();
  if (statistics.contacts_max > 0 || ticks.empty()) return {};
  const std::string nothing = "nothing was touched";
  const std::vector<Eigen::Vector3d> points = surface_points(simulation.workpiece());
  if (points.empty()) return nothing;
  const Burr& burr = simulation.burr();
  const std::size_t step = (ticks.size() + kMostTicks - 1) / kMostTicks;
  const ChartPoint* nearest = nullptr;
  double least_m = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < ticks.size(); i += step) {
    const double way_m = capsule_way(burr.capsule, ticks[i], points);
    if (way_m >= least_m) continue;
    least_m = way_m;
    nearest = &ticks[i];
  }
  const Eigen::Vector3d tip_mm = vector_of(nearest->tip_m) / kMillimetre;
  return nothing + formatted(
                       ": the burr came no nearer than about %.2f mm, at %.2f s with its tip "
                       "at (%.2f, %.2f, %.2f) mm",
                       std::max(0.0, burr_way(burr, *nearest, points)) / kMillimetre,
                       nearest->time_s, tip_mm.x(), tip_mm.y(), tip_mm.z());
}

}  // namespace sulcus
