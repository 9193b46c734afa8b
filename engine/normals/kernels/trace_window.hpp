// Which surfaces a trace sees, in all instruction sets.

#pragma once

#include <cstdint>

#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// Heights as far as they are known to either side: at the end of a window the next voxel is not,
/// so that a solid column would have a surface there, and at one end alone.
inline constexpr int kKnownReach = 31 - kLevel - 1;
inline constexpr std::uint32_t kTraceable = ((2u << (2 * kKnownReach)) - 1u)
                                            << (kLevel - kKnownReach);
static_assert(kKnownReach > kMaxTrace);

}  // namespace

}  // namespace sulcus
