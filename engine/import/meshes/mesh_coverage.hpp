#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/import/meshes/winding_number.hpp"
#include "engine/volume/fill_map.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// How much of each voxel a mesh encloses: pages of the leaves in which it says more than
/// `inside`, the model of the voxels whose centres are inside. The share of a voxel is that of
/// where the winding number is not 0; where closed parts overlap within one voxel, the sum of
/// theirs, up to full.
///
/// In closed form, by clipping each triangle to the voxels that it passes through: the mean of the
/// winding number over a voxel is the sum over the triangles below it along an axis, each by the
/// area that it covers of the voxel's section, and over those within it, by area times mean height
/// up to its upper face. (The "cover" and "area" by which FreeType draws smooth letters, with one
/// more dimension.) Between surfaces that mean is whole and is what `inside` says, else the mesh is
/// open there: then the two other axes are asked, and where all three fail, and in holes that no
/// triangle spans, 4 x 4 x 4 points of the voxel by `winding`.
///
/// `positions_index` in the grid's index space. Parallel (oneTBB); the result does not depend on
/// the number of threads.
std::vector<LeafLevels> mesh_coverage(const VoxelModel& inside,
                                      const std::vector<Eigen::Vector3d>& positions_index,
                                      const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                      const WindingNumber& winding);

}  // namespace sulcus
