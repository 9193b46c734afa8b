#pragma once

#include "engine/core/pose.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"

namespace sulcus {

/// A way that any point of a burr can go, in whatever direction, before any voxel of the workpiece
/// comes into contact; up to `wanted_m`, and a bound from below: 0 where it is near or in contact.
/// By the distance field where voxels are near, else by the capsule and the octree. Uses the
/// scratch: what an evaluation has left there is gone, and no contact is in it afterwards.
double free_distance(const Workpiece& workpiece, const Burr& burr, const Pose& world_from_tool,
                     double wanted_m, ContactScratch& scratch) noexcept;

}  // namespace sulcus
