#pragma once

#include "engine/volume/voxel_model.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace sulcus {

/// The occupancy a second time, packed along x, along y and along z, so that the voxels above and
/// below a surface voxel are one shifted word. A border of zeros (64 voxels along a column, 16
/// across) stands around the grid, so that a window of any map needs no test against its faces.
///
/// Columns along axis a are addressed by the other two coordinates in cyclic order:
/// (y, z) for x, (z, x) for y, (x, y) for z.
class ColumnBits {
 public:
  static constexpr int kBorder = 16;  // columns; a map may reach this far across the grid's face

  ColumnBits() = default;
  explicit ColumnBits(const VoxelModel& model);

  /// 64 voxels of a column from `start` upward, bit 0 first; voxels outside the grid are empty.
  /// Needs -kBorder <= u, v < cells + kBorder and -64 <= start <= cells.
  std::uint64_t window(int axis, int u, int v, int start) const noexcept {
    const Axis& a = axes_[axis];
    const std::uint64_t* column = a.words.data() + offset(a, u, v);
    const unsigned from = static_cast<unsigned>(start + 64);
    const unsigned shift = from & 63u;
    const std::uint64_t* w = column + (from >> 6);
    // Two shifts instead of one by 64 - shift, which is undefined for shift = 0.
    return w[0] >> shift | w[1] << 1 << (63u - shift);
  }

  void clear(const Cell& c) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
      Axis& a = axes_[axis];
      const unsigned bit = static_cast<unsigned>(c[axis] + 64);
      a.words[offset(a, c[(axis + 1) % 3], c[(axis + 2) % 3]) + (bit >> 6)] &=
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
    std::vector<std::uint64_t> words;
    std::size_t column_words = 0;  // 64 zeros, the voxels, at least 128 zeros
    std::size_t row_columns = 0;   // columns of one v
  };
  static std::size_t offset(const Axis& a, int u, int v) {
    return (static_cast<std::size_t>(v + kBorder) * a.row_columns + (u + kBorder)) *
           a.column_words;
  }
  std::array<Axis, 3> axes_;
};

}  // namespace sulcus
