#include "engine/normals/wide_map.hpp"

namespace sulcus {

void trace_wide(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                int neighbourhood, int trace, HeightMap& map) noexcept {
  map.ns = neighbourhood;
  map.stride = 2;
  trace_along(workpiece, voxel, axes, trace, map);
}

ColumnQuadric fit_whole(const HeightMap& map, const QuadricFilter& filter) noexcept {
  QuadricSums sums;
  map_kernels().fit(map.middle_row(), map.lanes, filter, sums);
  const int level = map.at(0, 0);
  return column_quadric(quadric_of(sums, level, level, map.sign, filter.solution), filter.answers,
                        static_cast<float>(map.stride));
}

}  // namespace sulcus
