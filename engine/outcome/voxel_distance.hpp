#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/outcome/voxel_set.hpp"

namespace sulcus {

// Exact distances between two sets of voxels of one grid, from centre to centre in voxels, as their
// squares, which are whole numbers. A tree of boxes over the leaves of a set (Eigen's KdBVH) leads
// to the few leaves in which the nearest voxel can be: the memory goes with the leaves that hold
// voxels, not with the grid.

/// Of the voxels of one set, each to the nearest of another, leaf by leaf in the order of its
/// leaves() and by their places in a leaf; empty where either set is. Runs on oneTBB.
std::vector<std::uint32_t> squared_distances(const VoxelSet& from, const VoxelSet& to);

/// The least over all pairs; none where either set is empty.
std::optional<std::uint32_t> least_squared_distance(const VoxelSet& a, const VoxelSet& b);

}  // namespace sulcus
