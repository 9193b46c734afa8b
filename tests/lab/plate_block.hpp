#pragma once

#include "engine/shapes/build_shape.hpp"
#include "tools/sulcus_lab/ticks/ticks_path.hpp"
#include "tools/sulcus_lab/ticks/ticks_run.hpp"

namespace sulcus::lab::test {

/// A tilted plate of 2 mm in 64^3 voxels of 0.07 mm, and a way over it along which it is level.
inline Workpiece plate_block() {
  Scene scene;
  scene.workpiece.shape = ShapeKind::kPlate;
  scene.workpiece.plate_thickness_m = 2e-3;
  scene.workpiece.plate_tilt = 0.2;
  scene.workpiece.cells = Eigen::Vector3i::Constant(64);
  scene.workpiece.voxel_m = 70e-6;
  scene.tissues = tick_tissues(1.0);
  return Workpiece(build_shape(scene));
}
inline const TickGround kBlockGround{{0.0, -0.1e-3}, {0.0, 0.1e-3}, 1.3e-3};

}  // namespace sulcus::lab::test
