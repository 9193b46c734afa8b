#pragma once

#include <string_view>

#include "engine/heat/conduction.hpp"

namespace sulcus {

/// Of enamel, dentine and pulp, by name; of any other tissue, caries among them, that of dentine.
ThermalMaterial thermal_material(std::string_view tissue) noexcept;

}  // namespace sulcus
