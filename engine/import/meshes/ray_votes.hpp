#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/volume/grid.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What the lines through the voxel centres along one axis say about inside and outside.
struct RayVotes {
  int axis = 0;
  ZeroedArray<LeafBits> solid;        // grid.leaf_count(): where the winding number is not 0
  std::vector<std::uint8_t> unsound;  // of each line: entries and exits do not cancel (a hole)
  bool all_sound = true;

  /// The line of a voxel: the two other axes in cyclic order, the first fastest.
  static std::size_t line(const VoxelGrid& grid, int axis, const Cell& c) {
    const int b = (axis + 1) % 3, d = (axis + 2) % 3;
    return static_cast<std::size_t>(c[b]) +
           static_cast<std::size_t>(grid.cells[b]) * static_cast<std::size_t>(c[d]);
  }
};

/// Winding numbers along every line: each triangle that a line crosses adds one where it enters and
/// takes one where it leaves. Exact for closed meshes, whichever way round their triangles are.
/// `positions_index`: in the grid's index space. Parallel (oneTBB), deterministic.
RayVotes cast_rays(const VoxelGrid& grid, int axis,
                   const std::vector<Eigen::Vector3d>& positions_index,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace sulcus
