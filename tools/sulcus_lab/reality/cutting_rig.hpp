#pragma once

#include <optional>
#include <string_view>

#include "engine/scene/scene.hpp"

namespace sulcus::lab {

inline constexpr double kQuickVoxel_mm = 0.06;

/// A fissure burr pressed on its side into the edge of a bar, as in scenes/side_cut.toml: the patch
/// that it cuts stays the same. Tissues are as stiff as behind a coupling, 300 N/mm, so that the
/// burr turns at its surface and not within the tooth.
struct CuttingTrial {
  CuttingLaw law = CuttingLaw::kSaturating;
  double load_N = 1.0;
  std::optional<double> held_rpm = {};  // none: the turbine, whose speed sags
  std::string_view burr = {};           // more keys of [burr], a line each
  std::string_view tissue = "enamel";
  double diameter_mm = 1.0;
  double voxel_mm = 0.04;
};

/// Over the last half of a second, when the turbine has settled.
struct CuttingMeasure {
  double mm3_per_s = 0.0;         // removed and part-cut
  double tangential_ratio = 0.0;  // of the burr's tangential to its normal force
  double rpm = 0.0;
};

CuttingMeasure measure_cutting(const CuttingTrial& trial);

}  // namespace sulcus::lab
