#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace sulcus {

/// 512 voxels of one leaf: word k holds the z slice k, bit x + 8 y a voxel of it. So a voxel's
/// place (leaf_place) is 64 times its word, and its bit.
struct alignas(64) LeafBits {
  std::array<std::uint64_t, 8> words{};

  bool has(int place) const { return (words[place >> 6] >> (place & 63) & 1u) != 0; }
  void set(int place) { words[place >> 6] |= std::uint64_t{1} << (place & 63); }
  void reset(int place) { words[place >> 6] &= ~(std::uint64_t{1} << (place & 63)); }
  bool operator==(const LeafBits&) const = default;
};

/// Calls `visit(place)` for each voxel, rising.
template <class Visit>
void for_each_voxel(const LeafBits& bits, const Visit& visit) {
  for (int k = 0; k < 8; ++k) {
    for (std::uint64_t rest = bits.words[k]; rest != 0; rest &= rest - 1) {
      visit(k << 6 | std::countr_zero(rest));
    }
  }
}

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
