#pragma once

#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact.hpp"

namespace sulcus {

/// Surface voxels of `scratch.leaves` whose centre is nearer to the burr than `reach_m` (0 where
/// depth is measured at centres), by trilinear interpolation of its distance field, into
/// `scratch.contacts` in the order of the leaves; adds to `result.tested`. A leaf farther from the
/// burr than its own half diagonal is passed over by one sample at its centre. Beyond the
/// capacity the deepest are kept, in the same order, and kFaultContactsFull is set.
void narrow_phase(const Workpiece& workpiece, const DistanceField& field,
                  const Pose& world_from_tool, double reach_m, ContactScratch& scratch,
                  ContactResult& result) noexcept;

}  // namespace sulcus
