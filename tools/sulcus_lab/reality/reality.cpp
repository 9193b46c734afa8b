#include "tools/sulcus_lab/reality/reality.hpp"

namespace sulcus::lab {

std::span<const RealitySection> reality_sections() noexcept {
  static constexpr std::array kSections{
      RealitySection{"rates", reality_rates},
      RealitySection{"handpieces", reality_handpieces},
      RealitySection{"preparations", reality_preparations},
  };
  return kSections;
}

}  // namespace sulcus::lab
