#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/volume/fill_map.hpp"
#include "engine/volume/leaf_bits.hpp"
#include "engine/volume/tissue_map.hpp"

namespace sulcus {

/// The voxels of a leaf that are filled at all, and so solid.
inline LeafBits filled_voxels(const LevelBlock& levels) {
  LeafBits filled;
  for (int place = 0; place < 512; ++place) {
    if (levels[static_cast<std::size_t>(place)] != 0) filled.set(place);
  }
  return filled;
}

/// The labels of a leaf, one by one.
inline LabelBlock labels_of(const TissueMap& tissues, std::uint32_t leaf) {
  if (const LabelBlock* block = tissues.block(leaf)) return *block;
  LabelBlock labels;
  labels.fill(tissues.uniform_label(leaf));
  return labels;
}

}  // namespace sulcus
