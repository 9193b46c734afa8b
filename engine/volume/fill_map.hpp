#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/grid.hpp"
#include "engine/volume/leaf_bits.hpp"

namespace sulcus {

/// How much of a voxel is filled, in parts of 255: of a solid voxel 1 to kFullLevel, of an empty
/// one 0.
using FillLevel = std::uint8_t;
inline constexpr FillLevel kFullLevel = 255;

/// Fill levels of the 512 voxels of a leaf, by leaf_place; 0 where it is empty.
using LevelBlock = std::array<FillLevel, 512>;
struct LeafLevels {
  std::uint32_t leaf = 0;
  LevelBlock levels{};
};

/// Pages that were made side by side.
std::vector<LeafLevels> joined(std::span<const std::vector<LeafLevels>> parts);

/// The filled fractions of a solid's voxels: a page of 512 bytes for each leaf that has a voxel
/// which is not full, which are those at its surface; in all others what is solid is full. A voxel
/// is solid where its level is above 0. One thread writes it; reading by several.
///
/// Column sums of fractions are the height functions of the volume-of-fluid methods [Cummins,
/// Francois and Kothe 2005; Popinet 2009].
class FillMap {
 public:
  FillMap() = default;
  /// `pages` of different leaves, in any order; each has the levels of the solid voxels of its
  /// leaf.
  FillMap(std::uint32_t leaf_count, std::vector<LeafLevels> pages);

  /// Null where all solid voxels of the leaf are full.
  const FillLevel* page(std::uint32_t leaf) const noexcept {
    const std::uint32_t at = page_of_leaf_[leaf];
    return at == kNoPage ? nullptr : pages_[at].levels.data();
  }
  /// Of a solid voxel.
  FillLevel level(std::uint32_t leaf, int place) const noexcept {
    const FillLevel* const levels = page(leaf);
    return levels ? levels[place] : kFullLevel;
  }
  /// Room for so many pages more, so that `set` need not allocate.
  void reserve(std::uint32_t more);
  /// Whether `set` may give a leaf without a page one.
  bool has_room() const noexcept { return pages_.size() < pages_.capacity(); }
  /// `solid`: the leaf's voxels before it. Needs a page or room for one, where the level is not
  /// full.
  void set(std::uint32_t leaf, int place, FillLevel level, const LeafBits& solid) noexcept;

  std::uint32_t leaf_count() const { return static_cast<std::uint32_t>(page_of_leaf_.size()); }
  /// Rising by leaf as made; those that `set` added follow.
  const std::vector<LeafLevels>& pages() const { return pages_; }
  std::size_t memory_bytes() const {
    return page_of_leaf_.capacity() * sizeof(std::uint32_t) +
           pages_.capacity() * sizeof(LeafLevels);
  }

 private:
  static constexpr std::uint32_t kNoPage = ~std::uint32_t{0};

  std::vector<std::uint32_t> page_of_leaf_;
  std::vector<LeafLevels> pages_;
};

}  // namespace sulcus
