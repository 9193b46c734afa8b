#pragma once

#include <Eigen/Core>

#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Minus the sum of unit vectors to the solid voxels within 2.5 of a voxel, index space, in whole
/// parts of 1 / 120, so that it is exact in any order and equal shapes, mirrored ones too,
/// have equal ones. Its largest component names the dominant axis. Zero where the solid around the
/// voxel is symmetric (a lone voxel, a wall of one voxel). Pure, no allocation.
Eigen::Vector3i coarse_normal(const Workpiece& workpiece, const Cell& voxel) noexcept;

/// Half the sum of the offsets of solid voxels, of those of a cube of 13 that are an even number of
/// voxels off along every axis, and no farther than the neighbourhood: within the window of any
/// map. It mostly tells apart what is equal in the coarse normal: on a sphere two axes dominate 7 %
/// of the voxels, and 0.8 % after that. Pure, no allocation.
Eigen::Vector3i solid_offsets(const Workpiece& workpiece, const Cell& voxel,
                              int neighbourhood) noexcept;

/// The rows that MapKernels::coarse adds up for it.
inline ColumnBits::Windows coarse_rows(const Workpiece& workpiece, const Cell& c) noexcept {
  return workpiece.columns().around(0, c.y(), c.z(), c.x() - 2);
}

}  // namespace sulcus
