#include "haptics/normals.hpp"

#include "engine/normals/normal_method.hpp"

namespace sulcus {

void normals(const Workpiece& workpiece, const HapticsSettings& settings,
             ContactScratch& scratch) noexcept {
  const auto voxel_m = static_cast<float>(workpiece.grid().voxel_m);
  for (Contact& contact : scratch.contacts) {
    const SurfaceEstimate estimate = estimate_surface(workpiece, contact.cell, settings);
    if (!estimate.defined) continue;
    contact.normal = estimate.normal;
    contact.offset_m = estimate.offset * voxel_m;
  }
}

}  // namespace sulcus
