#include <string>
#include <vector>

#include "tools/sulcus_lab/reality/pulp_after_a_minute.hpp"
#include "tools/sulcus_lab/reality/reality.hpp"

namespace sulcus::lab {

std::vector<RealityRow> reality_heat(const RealityOptions& options) {
  RealityRow dry{"pulp after 60 s at 1 N, dry, K", "Farah 2019 (fitted)", 4.0, 10.0, {}};
  RealityRow water{"pulp after 60 s at 1 N, with 23 C water, K", "Farah 2019", -12.0, -5.0, {}};
  for (const CuttingLaw law : {CuttingLaw::kPaper, CuttingLaw::kSaturating}) {
    options.progress(dry.check);
    std::vector<std::string> overrides{
        "cutting.law=" + std::string(kCuttingLawNames[static_cast<std::size_t>(law)])};
    if (options.quick) {
      overrides.insert(overrides.end(),
                       {"workpiece.voxel_mm=0.24", "workpiece.cells=[64, 56, 104]"});
    }
    const PulpFigures pulp = pulp_after_a_minute(overrides);
    dry.value[static_cast<std::size_t>(law)] = pulp.dry_K;
    water.value[static_cast<std::size_t>(law)] = pulp.water_K;
  }
  return {dry, water};
}

}  // namespace sulcus::lab
