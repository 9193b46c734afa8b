#pragma once

#include <cstdint>
#include <vector>

#include "engine/surface/surface_nets.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Moves the vertices of a net around a model with fractions onto its surface, each along the axis
/// of the grid to which the surface is steepest. `solid`: the block of the net in a lattice of
/// cells of 2^`cell_level` voxels, with how much of each cell is solid (of all tissues). The
/// surface is where the heights of columns have it, sums of fills: planes are exact, and parabolas,
/// of which nine columns about a vertex have the mean heights; or four, where an edge is near. A
/// vertex stays where it is if these are not columns of one face: at edges, and in crumbs and
/// cracks of a voxel or two. A wall that no voxel of is full is as thick as its voxels are filled,
/// about their centre. Beyond a quarter of a cell a vertex goes less far, and none goes half a
/// cell.
///
/// The place of a vertex depends on voxels up to kColumnReach from where it was, and on the eight
/// samples round it, so blocks agree about those that they share.
/// `at_surface`, where it is not null: 1 for vertices with a sample of 0.5 or less about them, the
/// only ones that are moved, 0 for others.
void move_to_columns(const VoxelModel& model, int cell_level, const NetsBlock& solid,
                     NetsMesh& mesh, std::vector<std::uint8_t>* at_surface = nullptr);

/// Voxels, along each axis.
inline constexpr int kColumnReach = 6;

}  // namespace sulcus
