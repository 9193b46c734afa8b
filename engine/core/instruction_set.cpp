#include "engine/core/instruction_set.hpp"

#include <cstdlib>
#include <string_view>

namespace sulcus {

#if defined(__x86_64__)

bool has(InstructionSet set) noexcept {
  switch (set) {
    case InstructionSet::kAvx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512vbmi") && __builtin_cpu_supports("avx512vbmi2") &&
             __builtin_cpu_supports("avx512vnni") && __builtin_cpu_supports("fma");
    case InstructionSet::kAvx2:
      return __builtin_cpu_supports("avx2");
    case InstructionSet::kPlain:
      break;
  }
  return true;
}

#else

/// The plain kernels are vectors of GCC's, which it makes into what the processor has.
bool has(InstructionSet set) noexcept { return set == InstructionSet::kPlain; }

#endif

InstructionSet instruction_set() noexcept {
  static const InstructionSet used = [] {
    const char* const asked = std::getenv("SULCUS_INSTRUCTIONS");
    auto set = InstructionSet::kPlain;
    for (const auto next : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      const char* const name = kInstructionSetNames[static_cast<std::size_t>(set)];
      if (!has(next) || (asked && std::string_view(asked) == name)) break;
      set = next;
    }
    return set;
  }();
  return used;
}

}  // namespace sulcus
