#pragma once

#include <optional>

#include "engine/normals/normal_settings.hpp"

namespace sulcus {

/// Settings of normals, and the error that they promise.
struct NormalChoice : NormalSettings {
  double error_deg = 0.0;  // mean over a smooth surface, away from its edges
};

/// The cheapest setting whose normals are within `error_deg` of the true ones on average, over a
/// surface away from its edges (haptics.normal_error_deg); none where even the best is not.
/// Promised for surfaces no finer than those it was measured on: tubes of radius 12 voxels, a
/// tooth's fissures at 0.07 mm.
std::optional<NormalChoice> choose_normals(double error_deg);

/// The setting with the least error: what can be met.
NormalChoice most_accurate_normals();

}  // namespace sulcus
