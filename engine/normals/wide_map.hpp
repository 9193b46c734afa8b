#pragma once

#include <cmath>
#include <optional>

#include "engine/normals/ldm_tuning.hpp"
#include "engine/normals/map_batch.hpp"
#include "engine/normals/quadric_filter.hpp"

namespace sulcus {

/// Traces the map of a voxel with this coarse normal of every other column, which sees twice as
/// far, where `has_wide_maps`.
void trace_wide(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                const Eigen::Vector3f& coarse, int neighbourhood, int trace,
                HeightMap& map) noexcept;

/// The surface of a whole map, by its filter.
ColumnQuadric fit_whole(const HeightMap& map, const QuadricFilter& filter) noexcept;

/// Whether a wide map's surface departs from a plane by at most so much across itself, half a map
/// out.
inline bool is_curved_at_most(float most, const ColumnQuadric& surface, const ClosestPoint& closest,
                              int neighbourhood) {
  const float curvatures =
      (std::abs(surface.c[3]) + std::abs(surface.c[5])) + std::abs(surface.c[4]);  // a column out
  return curvatures * closest.normal_z <= most / static_cast<float>(neighbourhood * neighbourhood);
}
inline bool is_face(const ColumnQuadric& surface, const ClosestPoint& closest, int neighbourhood) {
  return is_curved_at_most(kWideCurvature, surface, closest, neighbourhood);
}

/// The face that all columns of a wide map lie on that were found, from a plane near to it: those
/// of a steep one leave the trace, so that its map is not whole. None where there is none, or where
/// less than 0.6 of the columns were found.
std::optional<ClosestPoint> extended_plane(const HeightMap& wide,
                                           const ClosestPoint& first) noexcept;

}  // namespace sulcus
