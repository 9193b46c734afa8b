#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/triangle_mesh.hpp"
#include "engine/recording/hdf5_handle.hpp"
#include "engine/volume/input_geometry.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

// The part of a recording that never changes: it is written before readers are let in, so it may
// be compressed.
//
//   /workpiece  attributes cells u32[3], voxel_m f64, clipped u8, check u64 (XXH3-64 over all)
//     leaves        u32[n]       indices of the leaves with a solid voxel, rising
//     words         u64[n][8]    their voxels, as LeafBits
//     leaf_labels   u8[n]        their tissue; with it and the next two only where there are labels
//     mixed         u32[m]       which of the n leaves hold more than one tissue, rising
//     mixed_labels  u8[m][512]   the tissues of their voxels, x fastest
//   /bodies     only where the scene has others than the workpiece
//     0, 1, ...     each as /workpiece
//   /goal       as /workpiece, only where the goal comes from a file: what that holds, on its grid
//   /input      where the workpiece's file lies, only where it comes from one: attributes
//               file_from_scene f64[3][4] (m, rows), of a volume's lattice sizes f64[3] (of a mesh
//               0), spacing_m, origin_m f64[3], direction f64[3][3] (rows), and check u64
//   /burr       attribute check u64
//     positions     f32[p][3]    m, tool space
//     triangles     u32[t][3]
//
// Labels of leaves without a solid voxel are not kept: nothing can come to be there.

/// A solid as a group: "workpiece", "goal" or one of the bodies. Throws Hdf5Error.
void write_model(const Hdf5Handle& parent, const char* name, const VoxelModel& model);
/// `file_bytes` bounds what the file can hold, and so the memory taken. Throws Hdf5Error where
/// there is no such group or it is damaged.
VoxelModel read_model(const Hdf5Handle& parent, const char* name, std::uint64_t file_bytes);

/// Throws Hdf5Error.
void write_bodies(const Hdf5Handle& file, std::span<const VoxelModel* const> models);
void write_input(const Hdf5Handle& file, const InputGeometry& input);
void write_burr(const Hdf5Handle& file, const TriangleMesh& mesh_tool);

/// The grids alone, checked: the workpiece's, then those of the other bodies. Throws Hdf5Error.
std::vector<VoxelGrid> read_grids(const Hdf5Handle& file);
/// Of the bodies besides the workpiece. Throws Hdf5Error.
std::vector<VoxelModel> read_bodies(const Hdf5Handle& file, std::uint64_t file_bytes);
/// None where no goal names a file. Throws Hdf5Error, also where it is on another grid than the
/// workpiece.
std::optional<VoxelModel> read_goal(const Hdf5Handle& file, std::uint64_t file_bytes);
/// None where the workpiece is a built-in shape, and in a recording that was made before they had
/// it. Throws Hdf5Error.
std::optional<InputGeometry> read_input(const Hdf5Handle& file);
/// Empty where the scene generates the burr. Throws Hdf5Error.
std::optional<TriangleMesh> read_burr(const Hdf5Handle& file, std::uint64_t file_bytes);

}  // namespace sulcus
