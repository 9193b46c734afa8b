#include <algorithm>
#include <cstdio>

#include "app/inspect/inspect.hpp"
#include "engine/core/units.hpp"
#include "engine/import/medical_volume.hpp"

namespace sulcus {

void inspect_volume(const std::string& file) {
  const MedicalVolume volume = read_medical_volume(file);
  const auto [least, most] = std::minmax_element(volume.values.begin(), volume.values.end());
  const auto solid =
      std::count_if(volume.values.begin(), volume.values.end(), [](float v) { return v > 0.0f; });
  const Eigen::Vector3d mm = volume.spacing_m / kMillimetre;
  std::printf("volume           %d x %d x %d voxels\n", volume.sizes.x(), volume.sizes.y(),
              volume.sizes.z());
  std::printf("spacing          %g x %g x %g mm%s\n", mm.x(), mm.y(), mm.z(),
              volume.spacing_known ? "" : " (not said by the file)");
  std::printf("values           %g to %g\n", static_cast<double>(*least),
              static_cast<double>(*most));
  std::printf("voxels above 0   %td (%.3f mm3)\n", solid, static_cast<double>(solid) * mm.prod());
}

}  // namespace sulcus
