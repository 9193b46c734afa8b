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

  /// 64 voxels of each column around one, from a height on: `window(i, j)` is the column i further
  /// in the first coordinate and j in the second, bit 0 lowest; voxels outside the grid are empty.
  class Windows {
   public:
    std::uint64_t window(int i, int j) const noexcept {
      const std::uint64_t* w = lower_ + i + j * row_;
      // Two shifts instead of one by 64 - shift, which is undefined for shift = 0.
      return w[0] >> shift_ | w[plane_] << 1 << (63u - shift_);
    }

   private:
    friend class ColumnBits;
    const std::uint64_t* lower_ = nullptr;
    std::ptrdiff_t row_ = 0, plane_ = 0;
    unsigned shift_ = 0;
  };

  ColumnBits() = default;
  explicit ColumnBits(const VoxelModel& model);

  /// Needs -64 <= start <= cells along the axis; columns up to kBorder beyond the grid may be
  /// asked.
  Windows around(int axis, int u, int v, int start) const noexcept {
    const Axis& a = axes_[axis];
    const unsigned from = static_cast<unsigned>(start + 64);
    Windows windows;
    windows.lower_ = a.words.data() + a.offset(u, v, from >> 6);
    windows.row_ = static_cast<std::ptrdiff_t>(a.row);
    windows.plane_ = static_cast<std::ptrdiff_t>(a.plane);
    windows.shift_ = from & 63u;
    return windows;
  }
  std::uint64_t window(int axis, int u, int v, int start) const noexcept {
    return around(axis, u, v, start).window(0, 0);
  }

  void clear(const Cell& c) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
      Axis& a = axes_[axis];
      const unsigned bit = static_cast<unsigned>(c[axis] + 64);
      a.words[a.offset(c[(axis + 1) % 3], c[(axis + 2) % 3], bit >> 6)] &=
          ~(std::uint64_t{1} << (bit & 63u));
    }
  }

  std::size_t memory_bytes() const {
    std::size_t bytes = 0;
    for (const Axis& a : axes_) bytes += a.words.capacity() * sizeof(std::uint64_t);
    return bytes;
  }

 private:
  struct Axis {
    std::vector<std::uint64_t> words;  // [height][v][u], with the borders
    std::size_t row = 0;               // words from one v to the next
    std::size_t plane = 0;             // words from one height to the next

    std::size_t offset(int u, int v, std::size_t word) const noexcept {
      return word * plane + static_cast<std::size_t>(v + kBorder) * row +
             static_cast<std::size_t>(u + kBorder);
    }
  };
  std::array<Axis, 3> axes_;
};

}  // namespace sulcus
