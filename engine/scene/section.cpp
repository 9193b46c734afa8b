#include "engine/scene/section.hpp"

#include <charconv>
#include <cmath>
#include <string>

#include "engine/core/units.hpp"

namespace sulcus {

std::optional<Section> parse_section(std::string_view text) {
  std::string plain(text);
  std::erase(plain, ' ');
  if (plain.size() < 3 || plain[0] < 'x' || plain[0] > 'z' || plain[1] != '=') return {};
  double at_mm = 0.0;
  const char* const end = plain.data() + plain.size();
  const auto [next, error] = std::from_chars(plain.data() + 2, end, at_mm);
  if (error != std::errc{} || next != end || !std::isfinite(at_mm)) return {};
  return Section{plain[0] - 'x', at_mm * kMillimetre};
}

}  // namespace sulcus
