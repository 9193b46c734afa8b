#include "haptics/cutting_law.hpp"

#include <array>

namespace sulcus {

namespace {

/// Mean size of the diamonds, um: fine, medium, coarse, super-coarse, ISO 6360 numbers 514, 524,
/// 534 and 544, as Komet's catalogue has them.
constexpr std::array kGrainSizes_um{46.0, 107.0, 151.0, 181.0};
constexpr double kMedium_um = kGrainSizes_um[static_cast<std::size_t>(Grit::kMedium)];

}  // namespace

SaturatingLaw::SaturatingLaw(const BurrSettings& burr, const SaturatingConstants& constants)
    : area_m2_(constants.grain_area_m2), best_m_per_s_(constants.carbide_m_per_s), sharpness_(1.0) {
  if (burr.material == BurrMaterial::kCarbide) return;
  const double size = kGrainSizes_um[static_cast<std::size_t>(burr.grit)] / kMedium_um;
  area_m2_ *= size * size;
  best_m_per_s_ = constants.diamond_m_per_s;
  sharpness_ = 1.0 / (1.0 + burr.worn_m / (constants.wear_length_m * size * size));
}

}  // namespace sulcus
