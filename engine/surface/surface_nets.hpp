#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// How the surface passes through a cell of eight samples. Corner (x, y, z) of a cell is bit
/// x + 2 y + 4 z of its code (1: inside). Edge 4 a + u + 2 w runs along axis a at (u, w) on the
/// two axes that follow a cyclically. One vertex per closed curve in which the surface meets the
/// cell's faces, so that sheets which only touch stay apart [Nielson 2004, dual marching cubes].
struct NetsCase {
  std::uint8_t vertices = 0;                     // 0 to 4
  std::array<std::int8_t, 12> vertex_of_edge{};  // -1 where the surface does not cross the edge
  std::int8_t pinched_face = -1;  // 2 a + side: the face that one curve crosses twice; -1: none
};

/// A block of a lattice of samples. Two spaces: lattice coordinates, and offsets in `values`.
struct NetsBlock {
  Eigen::Vector3i first = Eigen::Vector3i::Zero();  // lattice coordinates of values[0]
  Eigen::Vector3i dims = Eigen::Vector3i::Zero();   // samples along each axis
  std::vector<float> values;                        // x fastest
  // The lattice edges whose lower sample lies in [begin, end) are meshed. Samples begin - 2 to
  // end + 1 must be in the block.
  Eigen::Vector3i begin = Eigen::Vector3i::Zero();
  Eigen::Vector3i end = Eigen::Vector3i::Zero();
};

/// A vertex at lattice coordinates cell + offset, offset within [0, 1] as made. The two are kept
/// apart so that neighbouring blocks compute the same bits for a vertex which they share.
struct NetsVertex {
  Eigen::Vector3i cell;
  std::uint8_t part;  // which of the cell's vertices
  Eigen::Vector3f offset;
};

struct NetsMesh {
  std::vector<NetsVertex> vertices;                 // by cell, x fastest; begin - 1 <= cell < end
  std::vector<std::array<std::uint32_t, 4>> quads;  // counter-clockwise seen from outside
};

/// Room that is kept between blocks.
struct NetsScratch {
  std::vector<std::uint8_t> codes;
  std::vector<std::uint32_t> first_vertex;
};

/// Surface nets [Gibson 1998] of {value > level}: one quad per crossed lattice edge, each vertex
/// the mean of its crossings, which are interpolated linearly. Over a whole lattice with a border
/// of samples outside, every mesh edge belongs to two quads, in opposite directions. Blocks without
/// a crossing give an empty mesh. `mesh` is overwritten. Pure; any thread.
void surface_nets(const NetsBlock& block, float level, NetsScratch& scratch, NetsMesh& mesh);

/// Splits a quad along its shorter diagonal, so that thin folds do not show.
std::array<std::array<std::uint32_t, 3>, 2> split_quad(const std::array<std::uint32_t, 4>& quad,
                                                       const Eigen::Vector3f& a,
                                                       const Eigen::Vector3f& b,
                                                       const Eigen::Vector3f& c,
                                                       const Eigen::Vector3f& d);

/// A net around voxels at full resolution. A vertex lies in a cell, the cube between the centres
/// of eight voxels from `cell` on, at `cell + offset` in index space; a quad goes around the line
/// between the centres of a voxel inside and one outside.
struct VoxelNet {
  std::vector<Eigen::Vector3i> cells;               // of each vertex
  std::vector<Eigen::Vector3f> offsets;             // in its cell, 0 to 1; see move_to_columns
  std::vector<std::array<std::uint32_t, 4>> quads;  // counter-clockwise seen from outside
  // Of each vertex, 1: it is at the surface, and lies where that is; 0: between two tissues. Empty
  // without fractions, which say so.
  std::vector<std::uint8_t> at_surface;
};

/// The net around the solid voxels, or those of one label: closed, every edge of two quads in
/// opposite directions, capped at the grid's faces. Nothing is smoothed. Where the voxels touch
/// along an edge or at a corner a cell has several vertices. With fractions around those that are
/// more than half full, moved to where columns have the surface (move_to_columns).
/// Throws std::length_error beyond 2^32 - 1 vertices. Runs on oneTBB's threads; the result does
/// not depend on their number.
VoxelNet voxel_net(const VoxelModel& model, std::optional<std::uint8_t> tissue);

}  // namespace sulcus
