#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/triangle_mesh.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

struct ClosedSurfaceSettings {
  std::optional<std::uint8_t> tissue;  // only voxels of this label; none: all that are solid
  // Relaxation passes that take the staircase off; a vertex stays within half a voxel of the
  // centre of its cell, so the mesh still has the topology of the voxels.
  int smoothing_passes = 8;
};

/// The closed surface of a model's solid voxels at full resolution, in metres, world space. Where
/// the solid reaches the grid's faces it is capped there. Every edge belongs to two triangles, in
/// opposite directions. Voxels that touch at an edge or corner only are kept apart, unless that
/// would make four triangles meet at an edge. A model without such voxels gives an empty mesh. With
/// fractions the surface lies where they have it, within some hundredths of a voxel on smooth
/// faces, and is not smoothed; what is nowhere more than half full has none.
/// Throws std::length_error beyond 2^32 - 1 vertices. Runs on oneTBB's threads; the result does
/// not depend on their number.
TriangleMesh closed_surface(const VoxelModel& model, const ClosedSurfaceSettings& settings = {});

/// The closed surface of each of the labels from 0 to `tissues` - 1, empty where no solid voxel has
/// it. Together they fill the solid: where two tissues meet both meshes have the same triangles, in
/// opposite directions, since there is one place for a vertex in each cell, smoothed together
/// [Frisken 2022], without shrinking [Taubin 1995]. Each edge belongs to two triangles in opposite
/// directions, but several vertices lie at one place where a tissue touches itself at an edge or a
/// corner. Otherwise as closed_surface.
std::vector<TriangleMesh> tissue_surfaces(const VoxelModel& model, std::size_t tissues,
                                          int smoothing_passes = 8);

}  // namespace sulcus
