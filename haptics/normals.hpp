#pragma once

#include "engine/core/pose.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact.hpp"

namespace sulcus {

/// Normal and surface offset of every contact by the scene's method (engine/normals). Where the
/// solid around a voxel names no side, the burr's distance gradient there does; what is undefined
/// even so stays zero, and contact_force takes that gradient itself.
void normals(const Workpiece& workpiece, const DistanceField& field, const Pose& world_from_tool,
             const HapticsSettings& settings, ContactScratch& scratch) noexcept;

}  // namespace sulcus
