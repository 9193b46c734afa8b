#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "engine/core/huge_pages.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The occupancy a second time, packed along x, along y and along z, so that the voxels above and
/// below a surface voxel are one shifted word. It covers the box of the leaves that hold a solid
/// voxel, and a border of zeros around it, so that a window of any map around such a voxel needs no
/// test against faces; what is far from the solid takes no memory. Removal only ever shrinks the
/// solid, so the box stays right.
///
/// Columns along axis a are addressed by the other two coordinates in cyclic order:
/// (y, z) for x, (z, x) for y, (x, y) for z. The words of one height lie together, one after
/// another in the first of the two, so that the columns of a map's row are read in one go.
class ColumnBits {
 public:
  static constexpr int kBorder = 16;  // columns; a map may reach this far across the box's face
  static constexpr int kBelow = 16;   // voxels; a window may begin this far below the box

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
  /// Runs on oneTBB.
  explicit ColumnBits(const VoxelModel& model);

  /// First cell of the box of leaves with a solid voxel, as they were at the start, and the one
  /// behind the last; equal where there was none.
  const Cell& lower() const { return lower_; }
  const Cell& upper() const { return upper_; }

  /// Needs a column in the box (others up to kBorder beyond it may then be asked by their offset)
  /// and lower() - kBelow <= start <= upper() along the axis.
  Windows around(int axis, int u, int v, int start) const noexcept {
    const Axis& a = axes_[axis];
    const int from = start + a.below;
    assert(from >= 0 && start <= upper_[axis]);
    return {a.words.data() + a.offset(u, v, from >> 5), a.row, a.plane,
            static_cast<unsigned>(from) & 31u};
  }
  std::uint64_t window(int axis, int u, int v, int start) const noexcept {
    return around(axis, u, v, start).window(0, 0);
  }

  /// Both need a voxel in the box.
  void clear(const Cell& c) noexcept {
    for (int axis = 0; axis < 3; ++axis) word(axis, c) &= ~bit(axis, c);
  }
  void set(const Cell& c) noexcept {
    for (int axis = 0; axis < 3; ++axis) word(axis, c) |= bit(axis, c);
  }

  std::size_t memory_bytes() const {
    std::size_t bytes = 0;
    for (const Axis& a : axes_) bytes += a.words.capacity() * sizeof(std::uint32_t);
    return bytes;
  }

 private:
  struct Axis {
    HugePageVector<std::uint32_t> words;  // [height][v][u] of the box with its borders
    std::ptrdiff_t row = 0;               // words from one v to the next
    std::ptrdiff_t plane = 0;             // words from one height to the next
    std::ptrdiff_t origin = 0;  // of the column (0, 0) at the first height; may be negative
    int below = 0;              // bits below voxel 0 of a column; may be negative

    std::ptrdiff_t offset(int u, int v, int word) const noexcept {
      return origin + word * plane + v * row + u;
    }
  };
  std::uint32_t& word(int axis, const Cell& c) noexcept {
    Axis& a = axes_[axis];
    const int height = (c[axis] + a.below) >> 5;
    return a
        .words[static_cast<std::size_t>(a.offset(c[(axis + 1) % 3], c[(axis + 2) % 3], height))];
  }
  std::uint32_t bit(int axis, const Cell& c) const noexcept {
    return 1u << (static_cast<unsigned>(c[axis] + axes_[axis].below) & 31u);
  }
  void fill(const LeafBits& bits, const Cell& first) noexcept;

  Cell lower_ = Cell::Zero(), upper_ = Cell::Zero();
  std::array<Axis, 3> axes_;
};

}  // namespace sulcus
