#pragma once

#include <cstdint>

namespace sulcus::test {

/// Blocks of memory that this thread has taken so far, by new, malloc and their kin (Eigen takes
/// its own by malloc). Link allocation_count.cpp, once a program.
std::uint64_t allocation_count() noexcept;

}  // namespace sulcus::test
