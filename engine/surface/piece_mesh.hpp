#pragma once

#include <cstdint>
#include <span>

#include "engine/surface/drawn_surface.hpp"

namespace sulcus {

/// The closed surface of a piece cut loose from `solid`, in world coordinates, where the piece was.
/// `voxels`: VoxelGrid::linear of the solid's model, each once, in any order, at least one; whether
/// they have been removed from the solid already makes no difference. It is made as the solid's
/// surface is, in cells of the same size at the same places, so that a sound face does not move
/// when the piece comes loose; faces towards what was solid at the start are drawn as cut. Where
/// nothing of it shows in such cells, finer ones are taken; the mesh of a crumb less than three
/// voxels wide, or of a sheet of one, may still be empty. Throws std::invalid_argument for a voxel
/// beyond the grid. Any thread, while nothing is removed; runs on oneTBB, and the result does not
/// depend on its threads.
DrawnMesh piece_mesh(const DrawnSurface& solid, std::span<const std::uint32_t> voxels);

}  // namespace sulcus
