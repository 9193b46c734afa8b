#pragma once

#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "engine/core/instruction_set.hpp"

namespace sulcus::test {

inline std::string set_name(InstructionSet set) {
  return kInstructionSetNames[static_cast<std::size_t>(set)];
}

/// What a kernel beside the plain one is compiled for, and the names of tests on them.
inline auto fast_sets() {
  return ::testing::Values(InstructionSet::kAvx2, InstructionSet::kAvx512);
}
inline std::string set_of(const ::testing::TestParamInfo<InstructionSet>& info) {
  return set_name(info.param);
}

}  // namespace sulcus::test
