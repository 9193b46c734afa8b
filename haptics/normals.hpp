#pragma once

#include "engine/core/pose.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact.hpp"

namespace sulcus {

/// Normal and surface offset of every contact by the scene's method (engine/normals), which is told
/// the burr's distance gradient at the voxel. What is undefined stays zero; contact_force takes the
/// gradient itself there.
void normals(const Workpiece& workpiece, const DistanceField& field, const Pose& world_from_tool,
             const HapticsSettings& settings, ContactScratch& scratch) noexcept;

}  // namespace sulcus
