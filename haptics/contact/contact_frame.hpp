#pragma once

#include <cstdint>

#include "engine/core/pose.hpp"
#include "engine/tool/distance_field.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

/// A burr's pose over a grid, for loops in single precision. Voxels are counted from one near the
/// tip, so that the numbers stay small: single precision then errs by a few nanometres (a test).
struct ContactFrame {
  ContactFrame(const VoxelGrid& grid, const DistanceField& field, const Pose& world_from_tool,
               double reference_m);

  const float* values = nullptr;    // of the field
  std::int32_t row = 0, slice = 0;  // pitches
  std::int32_t most[3]{},
      most_kept[3]{};                 // last cell along each axis; last that is no mirror image
  float last[3]{}, spacing_m = 0.0f;  // last sample along each axis

  std::int32_t cell[3]{};         // the voxel that is counted from
  float base[3]{}, step[3][3]{};  // field space of its centre, and a voxel along each axis
  float world_from_tool[3][3]{};  // rows
  float arm_m[3]{};               // of its centre from the torque reference
  float voxel_m = 0.0f;
};

}  // namespace sulcus
