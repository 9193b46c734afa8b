#pragma once

#include <cstddef>

#include "engine/volume/fill_map.hpp"
#include "engine/volume/leaf_bits.hpp"

namespace sulcus {

/// The voxels of a leaf that are filled at all, and so solid.
inline LeafBits filled_voxels(const LevelBlock& levels) {
  LeafBits filled;
  for (int place = 0; place < 512; ++place) {
    if (levels[static_cast<std::size_t>(place)] != 0) filled.set(place);
  }
  return filled;
}

}  // namespace sulcus
