#pragma once

#include <span>

#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact.hpp"
#include "haptics/kept_normals.hpp"

namespace sulcus {

/// The contact of the burr at `world_from_tool` with the workpiece: contacts (in `scratch`),
/// wrench and, where it is asked for, stiffness (a coupling does). Broad phase, narrow phase,
/// normals, forces. Changes no state and no result by being called, so a coupling may call it any
/// number of times in a tick; cutting happens once, after it. `twist` is the tool's own motion, for
/// the tangential forces of cutting; null: no cutting, none. `kept` is read only, and may be null.
/// `tissues` are the scene's, by label. Does not allocate. Of contacts beyond a block what passes
/// is gone (Contacts): who wants it calls the stages one by one.
ContactResult evaluate_contact(const Workpiece& workpiece, std::span<const TissueSettings> tissues,
                               const Burr& burr, const Pose& world_from_tool, const Twist* twist,
                               const HapticsSettings& settings, const KeptNormals* kept,
                               ContactScratch& scratch, Asked asked = Asked::kForce) noexcept;

}  // namespace sulcus
