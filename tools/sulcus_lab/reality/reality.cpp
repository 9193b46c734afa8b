#include "tools/sulcus_lab/reality/reality.hpp"

namespace sulcus::lab {

std::span<const RealitySection> reality_sections() noexcept {
  static constexpr std::array kSections{
      RealitySection{"rates", reality_rates},
      RealitySection{"handpieces", reality_handpieces},
      RealitySection{"preparations", reality_preparations},
      RealitySection{"heat", reality_heat},
      RealitySection{"sound", reality_sound},
  };
  return kSections;
}

}  // namespace sulcus::lab
