#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/core/triangle_mesh.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

/// Parts of a welded mesh: triangles that share an edge are of one.
struct MeshShells {
  std::size_t count = 0;
  std::vector<std::uint32_t> of_triangle;  // from 0, in the order of their first triangles
};

MeshShells find_shells(const TriangleMesh& mesh);

/// Two shells, turned against each other, that overlap without one being the cavity of the other:
/// where both are, the winding number is 0 as outside, so that their overlap would be a hole.
struct ShellConflict {
  std::uint32_t inside_out = 0;  // the smaller one of the two, or else the later
  std::uint32_t other = 0;
  std::size_t overlap = 0;  // voxels of `inside_out` that others turned against it hold as well
};

/// The worst one, found on the lines along z through a grid's voxel centres; nothing where there is
/// none. A shell is a cavity where at least 99 % of its voxels lie within others that are turned
/// against it; of the rest no two that are turned against each other may share more than 1 %.
/// `positions_index`: the mesh's, in the grid's index space.
std::optional<ShellConflict> find_shell_conflict(
    const TriangleMesh& mesh, const MeshShells& shells, const VoxelGrid& grid,
    const std::vector<Eigen::Vector3d>& positions_index);

/// @throws InputError that describes the conflict, where there is one. `file` for the message.
void check_shells(const TriangleMesh& mesh, const VoxelGrid& grid,
                  const std::vector<Eigen::Vector3d>& positions_index, const std::string& file);

/// A grid of a hundred voxels along the longest side of a mesh, with the middle of its box in the
/// middle, where no scene gives one.
struct MeshLattice {
  VoxelGrid grid;
  std::vector<Eigen::Vector3d> positions_index;  // the mesh's
};
MeshLattice lattice_about(const TriangleMesh& mesh);

/// "shell 2 of 3, about (1, 2, 3) mm, turned against ...", in the mesh's own space.
std::string describe(const ShellConflict& conflict, const TriangleMesh& mesh,
                     const MeshShells& shells, double voxel_m);

}  // namespace sulcus
