#pragma once

#include <cstdint>
#include <optional>

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
/// would make four triangles meet at an edge. A model without such voxels gives an empty mesh.
/// Throws std::length_error beyond 2^32 - 1 vertices. Runs on oneTBB's threads; the result does
/// not depend on their number.
TriangleMesh closed_surface(const VoxelModel& model, const ClosedSurfaceSettings& settings = {});

}  // namespace sulcus
