#pragma once

#include "engine/normals/ldm.hpp"
#include "engine/normals/ldm_paper.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// Normal of one surface voxel by the method that a scene names. What is felt is what is seen:
/// forces and pictures call this.
inline SurfaceEstimate estimate_surface(const Workpiece& workpiece, const Cell& voxel,
                                        const HapticsSettings& settings) noexcept {
  switch (settings.normals) {
    case NormalMethod::kLdmPaper:
      return estimate_ldm_paper(workpiece, voxel, settings.neighbourhood, settings.trace);
    case NormalMethod::kLdm:
      break;
  }
  return estimate_ldm(workpiece, voxel, settings.neighbourhood, settings.trace);
}

}  // namespace sulcus
