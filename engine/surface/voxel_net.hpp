#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// A net around voxels at full resolution. A vertex lies in a cell, the cube between the centres
/// of eight voxels from `cell` on, at `cell + offset` in index space; a quad goes around the line
/// between the centres of a voxel inside and one outside.
struct VoxelNet {
  std::vector<Eigen::Vector3i> cells;               // of each vertex
  std::vector<Eigen::Vector3f> offsets;             // in its cell, 0 to 1
  std::vector<std::array<std::uint32_t, 4>> quads;  // counter-clockwise seen from outside
};

/// The net around the solid voxels, or those of one label: closed, every edge of two quads in
/// opposite directions, capped at the grid's faces. Nothing is smoothed. Where the voxels touch
/// along an edge or at a corner a cell has several vertices.
/// Throws std::length_error beyond 2^32 - 1 vertices. Runs on oneTBB's threads; the result does
/// not depend on their number.
VoxelNet voxel_net(const VoxelModel& model, std::optional<std::uint8_t> tissue);

}  // namespace sulcus
