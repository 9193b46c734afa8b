#pragma once

#include "engine/volume/workpiece.hpp"
#include "haptics/contact.hpp"

namespace sulcus {

/// Normal and surface offset of every contact by the scene's method (engine/normals). Undefined
/// stays zero here; contact_force then takes the tool's gradient.
void normals(const Workpiece& workpiece, const HapticsSettings& settings,
             ContactScratch& scratch) noexcept;

}  // namespace sulcus
