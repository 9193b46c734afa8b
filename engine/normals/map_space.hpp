#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Core>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/surface_estimate.hpp"

namespace sulcus {

/// Map space: the two axes across the one that a map is traced along, in cyclic order, and that
/// one, outward.
struct MapAxes {
  int axis = 0;  // that the columns run along
  int sign = 1;  // of outward along it

  std::uint8_t window() const { return static_cast<std::uint8_t>(1 << axis); }
  int first() const { return axis == 2 ? 0 : axis + 1; }
  int second() const { return axis == 0 ? 2 : axis - 1; }
};

/// How the map of a voxel with this coarse normal is traced: first along the larger of its
/// components across the axis, whichever that is, so that equal shapes have equal maps with their
/// axes exchanged, too.
inline TraceOrder trace_order(const Eigen::Vector3f& coarse, const MapAxes& axes) noexcept {
  const float first = std::abs(coarse[axes.first()]), second = std::abs(coarse[axes.second()]);
  return first > second   ? TraceOrder::kRowFirst
         : first < second ? TraceOrder::kColumnFirst
                          : TraceOrder::kBoth;
}

/// A direction of index space in map space, and back.
inline Eigen::Vector3f to_map_space(const Eigen::Vector3f& v, const MapAxes& axes) noexcept {
  return {v[axes.first()], v[axes.second()], static_cast<float>(axes.sign) * v[axes.axis]};
}
inline SurfaceEstimate to_index_space(const ClosestPoint& closest, const MapAxes& axes) noexcept {
  const float x = closest.normal_x, y = closest.normal_y;
  const float z = static_cast<float>(axes.sign) * closest.normal_z;
  // By cases, not by index: element-wise stores would block store forwarding.
  const Eigen::Vector3f normal = axes.axis == 0   ? Eigen::Vector3f(z, x, y)
                                 : axes.axis == 1 ? Eigen::Vector3f(y, z, x)
                                                  : Eigen::Vector3f(x, y, z);
  return {normal, closest.offset, true, axes.window()};
}

}  // namespace sulcus
