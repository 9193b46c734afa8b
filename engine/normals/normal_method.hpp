#pragma once

#include "engine/normals/surface_estimate.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Normal of one surface voxel by the method that a scene names. What is felt is what is seen:
/// forces and pictures call this. `outward`, index space, is what the tool knows of the surface,
/// zero where nothing is: see estimate_ldm; other methods do without it.
SurfaceEstimate estimate_surface(const Workpiece& workpiece, const Cell& voxel,
                                 const HapticsSettings& settings,
                                 const Eigen::Vector3f& outward = Eigen::Vector3f::Zero()) noexcept;

}  // namespace sulcus
