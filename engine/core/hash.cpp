#include "engine/core/hash.hpp"

#include <array>
#include <cstdio>

namespace sulcus {

std::string hex(std::uint64_t hash) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
  return text.data();
}

}  // namespace sulcus
