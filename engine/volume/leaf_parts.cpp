#include "engine/volume/leaf_parts.hpp"

namespace sulcus {

namespace {

/// What is connected to `found` in one slice.
std::uint64_t flood_slice(std::uint64_t found, std::uint64_t within) {
  found &= within;
  for (;;) {
    const std::uint64_t along_x = (found << 1 & ~kColumn0) | (found >> 1 & ~kColumn7);
    const std::uint64_t grown = (found | along_x | found << 8 | found >> 8) & within;
    if (grown == found) return found;
    found = grown;
  }
}

/// What is connected to the first voxel of `within`, which must have one: 64 voxels at a time,
/// up and down the slices until a pass finds nothing more.
LeafBits flood_from_first(const LeafBits& within) {
  LeafBits found;
  for (std::size_t k = 0; k < 8; ++k) {
    if (within.words[k] == 0) continue;
    found.words[k] = within.words[k] & (0 - within.words[k]);
    break;
  }
  for (bool grown = true; grown;) {
    grown = false;
    const auto grow = [&](std::size_t k, std::uint64_t beside) {
      const std::uint64_t flooded = flood_slice(found.words[k] | beside, within.words[k]);
      grown |= flooded != found.words[k];
      found.words[k] = flooded;
    };
    for (std::size_t k = 0; k < 8; ++k) grow(k, k > 0 ? found.words[k - 1] : 0);
    for (std::size_t k = 7; k-- > 0;) grow(k, found.words[k + 1]);
  }
  return found;
}

}  // namespace

void append_parts(const LeafBits& bits, std::vector<LeafBits>& parts) {
  for (LeafBits rest = bits; any(rest);) {
    parts.push_back(flood_from_first(rest));
    rest = without(rest, parts.back());
  }
}

}  // namespace sulcus
