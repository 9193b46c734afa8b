#pragma once

#include <Eigen/Core>

namespace sulcus {

/// A figure of a preparation, and the place where it is decided.
struct PlacedFigure {
  double value = 0.0;
  Eigen::Vector3d at_m{0, 0, 0};  // the space of the meshes
};

}  // namespace sulcus
