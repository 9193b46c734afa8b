#include "engine/normals/wide_map.hpp"

#include <span>

#include "engine/normals/grown_plane.hpp"
#include "engine/normals/ldm_tuning.hpp"

namespace sulcus {

void trace_wide(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                const Eigen::Vector3f& coarse, int neighbourhood, int trace,
                HeightMap& map) noexcept {
  map.ns = neighbourhood;
  map.stride = 2;
  trace_along(workpiece, voxel, axes, coarse, trace, map);
}

ColumnQuadric fit_whole(const HeightMap& map, const QuadricFilter& filter) noexcept {
  QuadricSums sums;
  map_kernels().fit(map.middle_row(), map.lanes, filter, sums);
  const int level = map.at(0, 0);
  return column_quadric(quadric_of(sums, level, level, map.sign, filter.solution), filter.answers,
                        static_cast<float>(map.stride));
}

std::optional<ClosestPoint> extended_plane(const HeightMap& wide,
                                           const ClosestPoint& first) noexcept {
  const auto rows = static_cast<std::size_t>(2 * wide.ns + 1);
  int found = 0;  // unlike std::count's 64 bits, an int is added up in vectors
  for (const signed char height :
       std::span(wide.height).first(rows * static_cast<std::size_t>(wide.lanes))) {
    found += height != HeightMap::kNone ? 1 : 0;
  }
  if (static_cast<float>(found) < kLeastShareFound * static_cast<float>(rows * rows)) return {};
  if (first.normal_z < kLeastPlaneCosine) return {};
  // Most that is no face shows near its first plane.
  const HeightPlane near = plane_through(first, wide.stride, kMostOffFirstPlane);
  PlaneLook look;
  map_kernels().look_at_plane(wide, near, look);
  if (look.count < found) return {};
  PlaneGrowth growth{&wide, near, found, PlaneStart::kFit, {}};
  grow_planes({&growth, 1});
  return growth.closest;
}

}  // namespace sulcus
