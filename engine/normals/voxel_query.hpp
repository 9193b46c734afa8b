#pragma once

#include <Eigen/Core>

#include "engine/volume/grid.hpp"

namespace sulcus {

/// A surface voxel whose normal is asked for.
struct VoxelQuery {
  Cell voxel;
  /// Out of the solid, index space, of any length: what the tool knows (minus the gradient of its
  /// distance field there). Zero where nothing is.
  Eigen::Vector3f outward = Eigen::Vector3f::Zero();
};

}  // namespace sulcus
