#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The occupancy a second time, packed along x, along y and along z, so that the voxels above and
/// below a surface voxel are one shifted word. A border of zeros (64 voxels along a column, 16
/// across) stands around the grid, so that a window of any map needs no test against its faces.
///
/// Columns along axis a are addressed by the other two coordinates in cyclic order:
/// (y, z) for x, (z, x) for y, (x, y) for z. The words of one height lie together, one after
/// another in the first of the two, so that the columns of a map's row are read in one go.
class ColumnBits {
 public:
  static constexpr int kBorder = 16;  // columns; a map may reach this far across the grid's face

  /// Voxels of each column around one, from a height on: `window(i, j)` is the column i further in
  /// the first coordinate and j in the second, bit 0 lowest; voxels outside the grid are empty.
  struct Windows {
    /// The word that holds bit 0 of column (0, 0): those of a row of columns follow one another,
    /// `row` words on are those of the next j, `plane` words on the next 32 voxels.
    const std::uint32_t* words = nullptr;
    std::ptrdiff_t row = 0, plane = 0;
    unsigned shift = 0;  // of bit 0 in its word, 0..31

    std::uint64_t window(int i, int j) const noexcept {
      const std::uint32_t* w = words + i + j * row;
      const std::uint64_t lower = w[0] | std::uint64_t{w[plane]} << 32;
      // Two shifts instead of one by 64 - shift, which is undefined for shift = 0.
      return lower >> shift | std::uint64_t{w[2 * plane]} << 1 << (63u - shift);
    }
  };

  ColumnBits() = default;
  explicit ColumnBits(const VoxelModel& model);

  /// Needs -64 <= start <= cells along the axis; columns up to kBorder beyond the grid may be
  /// asked.
  Windows around(int axis, int u, int v, int start) const noexcept {
    const Axis& a = axes_[axis];
    const unsigned from = static_cast<unsigned>(start + kBelow);
    return {a.words.data() + a.offset(u, v, from >> 5), static_cast<std::ptrdiff_t>(a.row),
            static_cast<std::ptrdiff_t>(a.plane), from & 31u};
  }
  std::uint64_t window(int axis, int u, int v, int start) const noexcept {
    return around(axis, u, v, start).window(0, 0);
  }

  void clear(const Cell& c) noexcept {
    for (int axis = 0; axis < 3; ++axis) *word_of(axis, c) &= ~bit_of(axis, c);
  }

  std::size_t memory_bytes() const {
    std::size_t bytes = 0;
    for (const Axis& a : axes_) bytes += a.words.capacity() * sizeof(std::uint32_t);
    return bytes;
  }

 private:
  static constexpr int kBelow = 64;  // zeros below the first voxel of a column

  struct Axis {
    std::vector<std::uint32_t> words;  // [height][v][u], with the borders
    std::size_t row = 0;               // words from one v to the next
    std::size_t plane = 0;             // words from one height to the next

    std::size_t offset(int u, int v, std::size_t word) const noexcept {
      return word * plane + static_cast<std::size_t>(v + kBorder) * row +
             static_cast<std::size_t>(u + kBorder);
    }
  };
  std::uint32_t* word_of(int axis, const Cell& c) noexcept {
    Axis& a = axes_[axis];
    const auto height = static_cast<std::size_t>(c[axis] + kBelow) >> 5;
    return a.words.data() + a.offset(c[(axis + 1) % 3], c[(axis + 2) % 3], height);
  }
  static std::uint32_t bit_of(int axis, const Cell& c) noexcept {
    return 1u << (static_cast<unsigned>(c[axis] + kBelow) & 31u);
  }
  std::array<Axis, 3> axes_;
};

}  // namespace sulcus
