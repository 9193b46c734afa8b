#include "engine/core/instruction_set.hpp"

#include <cstdlib>
#include <string_view>

namespace sulcus {

bool use_avx2() noexcept {
  static const bool use = [] {
    const char* asked = std::getenv("SULCUS_INSTRUCTIONS");
    return __builtin_cpu_supports("avx2") && !(asked && std::string_view(asked) == "plain");
  }();
  return use;
}

}  // namespace sulcus
