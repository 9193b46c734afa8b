#include "engine/heat/thermal_tissues.hpp"

namespace sulcus {

namespace {

/// Of a conductivity and a diffusivity, m2/s.
constexpr ThermalMaterial of(double conductivity_W_per_mK, double diffusivity) {
  return {conductivity_W_per_mK, conductivity_W_per_mK / diffusivity};
}

constexpr ThermalMaterial kEnamel = of(0.81, 4.08e-7);   // [Lin 2010]
constexpr ThermalMaterial kDentine = of(0.48, 2.01e-7);  // [Lin 2010]
constexpr ThermalMaterial kPulp{0.62, 4.15e6};           // water at 37 C [IAPWS]

}  // namespace

ThermalMaterial thermal_material(std::string_view tissue) noexcept {
  if (tissue == "enamel") return kEnamel;
  return tissue == "pulp" ? kPulp : kDentine;
}

}  // namespace sulcus
