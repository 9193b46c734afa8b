#pragma once

#include <cmath>

#include "engine/normals/map_group.hpp"
#include "engine/normals/quadric_filter.hpp"

namespace sulcus {

/// Traces the map of a voxel of every other column, which sees twice as far, where
/// `has_wide_maps`.
void trace_wide(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                int neighbourhood, int trace, HeightMap& map) noexcept;

/// The surface of a whole map, by its filter.
ColumnQuadric fit_whole(const HeightMap& map, const QuadricFilter& filter) noexcept;

/// Whether a wide map's surface is a face: it bends by no more than a tenth of a voxel across
/// itself, half a map out.
inline bool is_face(const ColumnQuadric& surface, const Foot& foot, int neighbourhood) {
  const float bends =
      std::abs(surface.c[3]) + std::abs(surface.c[4]) + std::abs(surface.c[5]);  // a column out
  return bends * foot.normal_z <= 0.1f / static_cast<float>(neighbourhood * neighbourhood);
}

}  // namespace sulcus
