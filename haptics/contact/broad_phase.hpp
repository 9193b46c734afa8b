#pragma once

#include <Eigen/Geometry>

#include "engine/core/pose.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"

namespace sulcus {

/// Leaves of the octree with surface voxels that the burr's capsule reaches, found in pre-order
/// [Kim and Park 2019, III], into `scratch.leaves`; internal nodes whose children are all gone into
/// `scratch.emptied_nodes` [III-B]. Returns false when the leaves did not all fit.
bool broad_phase(const Workpiece& workpiece, const Capsule& capsule_tool,
                 const Pose& world_from_tool, double margin_m, ContactScratch& scratch) noexcept;

/// Bounding box of the capsule in world space, `margin_m` wider: which bodies are near.
Eigen::AlignedBox3d capsule_bounds(const Capsule& capsule_tool, const Pose& world_from_tool,
                                   double margin_m) noexcept;

}  // namespace sulcus
