#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sulcus {

/// What kernels are compiled for; each has all of those before it. kAvx512 is what Ice Lake and
/// Zen 4 brought: F, BW, DQ, VL, VBMI, VBMI2 and VNNI.
enum class InstructionSet : std::uint8_t { kPlain, kAvx2, kAvx512 };
inline constexpr std::array<const char*, 3> kInstructionSetNames{"plain", "avx2", "avx512"};

/// Whether this processor has it.
bool has(InstructionSet set) noexcept;

/// The set whose kernels are to run: the last that this processor has, and no later one than the
/// environment names with SULCUS_INSTRUCTIONS, which is for comparing. Results do not depend on it.
InstructionSet instruction_set() noexcept;

inline const char* instruction_set_name() noexcept {
  return kInstructionSetNames[static_cast<std::size_t>(instruction_set())];
}

/// Of kernels compiled for each set (null: not in this build), in their order, those of one; null
/// too where the processor lacks it.
template <class Kernels>
const Kernels* kernels_of(InstructionSet set,
                          const std::array<const Kernels*, 3>& compiled) noexcept {
  return has(set) ? compiled[static_cast<std::size_t>(set)] : nullptr;
}

/// Of kernels written for several sets, those of the last one to be used that there are any for;
/// `kernels_of(set)` is null where the build has none. There are plain ones.
template <class KernelsOf>
const auto& fastest_kernels(const KernelsOf& kernels_of) noexcept {
  auto set = static_cast<int>(instruction_set());
  const auto* kernels = kernels_of(static_cast<InstructionSet>(set));
  while (!kernels) kernels = kernels_of(static_cast<InstructionSet>(--set));
  return *kernels;
}

}  // namespace sulcus
