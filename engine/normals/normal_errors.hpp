#pragma once

#include "engine/normals/normal_settings.hpp"
#include "engine/volume/voxel_values.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Of each surface voxel the angle, rad, between the normal that a scene's method finds of it,
/// without what a tool would know, and that of the offline reference (estimate_exact, of the same
/// neighbourhood). None where either is undefined. Seconds for a tooth; runs on oneTBB.
VoxelValues normal_errors(const Workpiece& workpiece, const NormalSettings& settings);

}  // namespace sulcus
