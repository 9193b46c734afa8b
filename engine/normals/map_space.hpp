#pragma once

#include <Eigen/Core>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/surface_estimate.hpp"

namespace sulcus {

/// Map space: the two axes across the one that a map is traced along, in cyclic order, and that
/// one, outward.
struct MapAxes {
  int axis = 0;  // that the columns run along
  int sign = 1;  // of outward along it
};

/// The axis of the largest component of a direction out of the solid.
inline MapAxes dominant_axes(const Eigen::Vector3f& outward) noexcept {
  MapAxes axes;
  outward.cwiseAbs().maxCoeff(&axes.axis);
  axes.sign = outward[axes.axis] > 0.0f ? 1 : -1;
  return axes;
}

/// A direction of index space, told in map space, and back.
inline Eigen::Vector3f to_map_space(const Eigen::Vector3f& v, const MapAxes& axes) noexcept {
  return {v[(axes.axis + 1) % 3], v[(axes.axis + 2) % 3],
          static_cast<float>(axes.sign) * v[axes.axis]};
}
inline SurfaceEstimate to_index_space(const Foot& foot, const MapAxes& axes) noexcept {
  SurfaceEstimate estimate;
  estimate.normal[(axes.axis + 1) % 3] = foot.normal_x;
  estimate.normal[(axes.axis + 2) % 3] = foot.normal_y;
  estimate.normal[axes.axis] = static_cast<float>(axes.sign) * foot.normal_z;
  estimate.offset = foot.offset;
  estimate.defined = true;
  return estimate;
}

}  // namespace sulcus
