#include "engine/normals/normal_method.hpp"

#include "engine/normals/exact.hpp"
#include "engine/normals/ldm.hpp"
#include "engine/normals/ldm_fast.hpp"
#include "engine/normals/ldm_paper.hpp"
#include "engine/normals/weighted_sum.hpp"

namespace sulcus {

SurfaceEstimate estimate_surface(const Workpiece& workpiece, const Cell& voxel,
                                 const HapticsSettings& settings,
                                 const Eigen::Vector3f& outward) noexcept {
  const int ns = settings.neighbourhood;
  switch (settings.normals) {
    case NormalMethod::kLdm:
      return estimate_ldm(workpiece, voxel, ns, settings.trace, outward);
    case NormalMethod::kLdmFast:
      return estimate_ldm_fast(workpiece, voxel, ns, settings.trace, outward);
    case NormalMethod::kLdmPaper:
      return estimate_ldm_paper(workpiece, voxel, ns, settings.trace);
    case NormalMethod::kWeightedSum:
      return estimate_weighted_sum(workpiece, voxel, ns, WeightedSum::kAsStated);
    case NormalMethod::kWeightedSumD2:
      return estimate_weighted_sum(workpiece, voxel, ns, WeightedSum::kAsPlotted);
    case NormalMethod::kExact:
      return estimate_exact(workpiece, voxel, ns);
  }
  return {};
}

}  // namespace sulcus
