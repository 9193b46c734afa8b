#pragma once

#include <cstdint>
#include <vector>

#include "engine/volume/leaf_bits.hpp"

namespace sulcus {

/// The six faces of a leaf, and the leaves beyond: -x, +x, -y, +y, -z, +z.
inline constexpr int kLeafFaces = 6;

/// Voxels of the leaf beyond a face, solid or not, that share a face with one of `bits`.
inline LeafBits across(const LeafBits& bits, int face) {
  LeafBits beyond;
  if (face >= 4) {
    beyond.words[face == 4 ? 7 : 0] = bits.words[face == 4 ? 0 : 7];
    return beyond;
  }
  for (std::size_t k = 0; k < 8; ++k) {
    const std::uint64_t w = bits.words[k];
    beyond.words[k] = face == 0   ? (w & kColumn0) << 7
                      : face == 1 ? w >> 7 & kColumn0
                      : face == 2 ? w << 56
                                  : w >> 56;
  }
  return beyond;
}

/// Appends the parts of `bits` whose voxels are connected by faces inside the leaf, by their first
/// voxel (z, then y, then x).
void append_parts(const LeafBits& bits, std::vector<LeafBits>& parts);

}  // namespace sulcus
