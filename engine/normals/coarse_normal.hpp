#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Minus the sum of unit vectors to the solid voxels within 2.5 of a voxel, index space, in whole
/// parts of 1 / 120, so that it is exact in any order and equal shapes, mirrored ones too,
/// have equal ones. Its largest component names the dominant axis. Zero where the solid around the
/// voxel is symmetric (a lone voxel, a wall of one voxel). Pure, no allocation.
Eigen::Vector3i coarse_normal(const Workpiece& workpiece, const Cell& voxel) noexcept;

/// What it is made of, for many at a time: the rows that MapKernels::coarse adds up, and what its
/// sums tell.
inline ColumnBits::Windows coarse_rows(const Workpiece& workpiece, const Cell& c) noexcept {
  return workpiece.columns().around(0, c.y(), c.z(), c.x() - 2);
}
/// Of so many queries; `rows` is room for as many.
void coarse_sums(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                 ColumnBits::Windows* rows, std::array<std::int32_t, 3>* sums) noexcept;

}  // namespace sulcus
