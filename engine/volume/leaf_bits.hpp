#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace sulcus {

/// 512 voxels of one leaf: word k holds the z slice k, bit x + 8 y a voxel of it.
struct alignas(64) LeafBits {
  std::array<std::uint64_t, 8> words{};
  bool operator==(const LeafBits&) const = default;
};

/// Voxels with x = 0, and with x = 7, in a slice of a leaf.
inline constexpr std::uint64_t kColumn0 = 0x0101010101010101u;
inline constexpr std::uint64_t kColumn7 = kColumn0 << 7;

inline bool any(const LeafBits& bits) {
  std::uint64_t all = 0;
  for (std::uint64_t word : bits.words) all |= word;
  return all != 0;
}

inline int count_voxels(const LeafBits& bits) {
  int voxels = 0;
  for (std::uint64_t word : bits.words) voxels += std::popcount(word);
  return voxels;
}

inline LeafBits operator&(const LeafBits& a, const LeafBits& b) {
  LeafBits both;
  for (std::size_t k = 0; k < both.words.size(); ++k) both.words[k] = a.words[k] & b.words[k];
  return both;
}

inline LeafBits& operator|=(LeafBits& a, const LeafBits& b) {
  for (std::size_t k = 0; k < a.words.size(); ++k) a.words[k] |= b.words[k];
  return a;
}

/// Voxels of a that are not in b.
inline LeafBits without(const LeafBits& a, const LeafBits& b) {
  LeafBits rest;
  for (std::size_t k = 0; k < rest.words.size(); ++k) rest.words[k] = a.words[k] & ~b.words[k];
  return rest;
}

}  // namespace sulcus
