#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/volume/grid.hpp"

namespace sulcus {

/// From voxel `first` on along its line the winding number is higher by `step`.
struct LineCrossing {
  int first = 0;
  int step = 0;  // 1 where the line enters, -1 where it leaves
  std::uint32_t triangle = 0;
};

/// Where the lines through the voxel centres along one axis cross a mesh, exact for every line:
/// what enters a closed mesh leaves it.
class LineCrossings {
 public:
  /// `positions_index`: in the grid's index space.
  LineCrossings(const VoxelGrid& grid, int axis,
                const std::vector<Eigen::Vector3d>& positions_index,
                const std::vector<std::array<std::uint32_t, 3>>& triangles);

  /// Of the line at b and c along the two other axes, in cyclic order; in order along it.
  std::span<const LineCrossing> of(int b, int c) const {
    const std::size_t l = static_cast<std::size_t>(b) +
                          static_cast<std::size_t>(lines_b_) * static_cast<std::size_t>(c);
    return std::span(crossings_).subspan(begin_[l], begin_[l + 1] - begin_[l]);
  }

 private:
  int lines_b_ = 0;
  std::vector<std::size_t> begin_;  // of each line's crossings
  std::vector<LineCrossing> crossings_;
};

}  // namespace sulcus
