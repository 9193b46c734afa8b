#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/grid.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Fills a closed or slightly open mesh: solid is every voxel whose centre has a generalised
/// winding number of more than 0.5 either way, so that it does not matter which way round the
/// triangles are, as long as they agree. Overlapping parts are one solid; a shell inside another,
/// turned the other way, is a cavity. One that is turned the other way and only half inside is
/// neither, and refused (find_shell_conflict).
///
/// Lines along the three axes decide where at least two of them are sound (they leave as often as
/// they enter) and none that is disagrees. That is everywhere for a closed mesh; beside holes the
/// winding number itself is evaluated [Jacobson et al. 2013; Barill et al. 2018].
///
/// With `settings.surface` kFractions a voxel is filled by the share of it that is inside
/// (mesh_coverage), rounded, and solid where that is not 0, wherever its centre lies.
///
/// `mesh` in metres. The centre of its bounding box comes to the scene's origin, is turned by
/// `settings.rotation` and moved by `settings.position_m`. `clipped` is set where the mesh reaches
/// beyond the grid. There are no labels: a mesh is of one tissue.
///
/// Parallel (oneTBB); the result does not depend on the number of threads.
/// @throws InputError: no voxel inside (too small, too open, or beside the grid); shells that
/// cancel where they overlap.
VoxelModel voxelise_mesh(const TriangleMesh& mesh, const VoxelGrid& grid,
                         const WorkpieceSettings& settings);

/// The surface of one tissue of several.
struct TissueSurface {
  TriangleMesh mesh;       // metres, in the space of them all
  std::string file;        // for messages
  std::uint8_t label = 0;  // of what lies within
};

/// Where meshes of one space come to lie: as `voxelise_mesh` says of one, by the box of them all.
Eigen::Affine3d world_from_surfaces(std::span<const TissueSurface> surfaces,
                                    const WorkpieceSettings& settings);

/// Fills several meshes, each as `voxelise_mesh` does: solid is what lies within any of them, and
/// a voxel is of the last one that it lies within. They are placed by `world_from_surfaces`. One
/// alone has no labels. There must be one.
///
/// With fractions a voxel that two of them fill in part has the greater share where their surfaces
/// look the same way, as of one within the other, and the sum of both, up to full, where they face
/// each other. It is of the last one that its centre lies within; where that is outside them all,
/// of the last one that fills as much of it as those before together.
/// @throws InputError: one of them encloses no voxel, or has shells as above.
VoxelModel voxelise_surfaces(std::span<const TissueSurface> surfaces, const VoxelGrid& grid,
                             const WorkpieceSettings& settings);

}  // namespace sulcus
