#pragma once

#include <cstdint>

#include "engine/import/volumes/lattice.hpp"

namespace sulcus {

/// Signed depth of every lattice point under the surface between solid points (1) and empty ones
/// (0), in lattice steps: from a solid point the distance to the nearest empty point less a half,
/// from an empty one minus that to the nearest solid point less a half. Exact, separable
/// [Felzenszwalb and Huttenlocher 2012]. Points of a lattice all solid (empty) get a large
/// positive (negative) depth.
Lattice<float> signed_depth(const Lattice<std::uint8_t>& solid);

}  // namespace sulcus
