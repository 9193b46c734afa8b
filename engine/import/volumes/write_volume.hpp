#pragma once

#include <cstdint>
#include <string>

#include "engine/core/input_limits.hpp"
#include "engine/volume/input_geometry.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What the voxels of an exported volume say.
enum class VolumeContent : std::uint8_t {
  kMask,    // 1 where solid
  kLabels,  // 1 + tissue where solid
  kFills,   // how much of it is filled, in parts of 255
};

/// Throws InputError unless the name ends in .nrrd, .mha or .nii.gz, in small or capital letters.
void check_volume_name(const std::string& path);

// All write uint8, compressed, 0 where empty, lengths in mm; the name decides the format.
// @throws InputError: another ending, a lattice that the format cannot hold (sheared axes, in all
// but .nrrd); std::runtime_error where the file cannot be written.

/// The voxels of `model`, the file's coordinates the scene's. Read back as a binary mask it holds
/// as many voxels.
void write_volume(const std::string& path, const VoxelModel& model, VolumeContent content);

/// The same voxels in the space of the file that the workpiece came from, by origin and directions
/// alone, so that they lie over it.
void write_volume_in_file_space(const std::string& path, const VoxelModel& model,
                                VolumeContent content, const InputGeometry& input);

/// Resampled to the lattice of the file that the workpiece came from: a voxel is solid where at
/// least half of it is, and of the tissue that most of that has; of fills it is their mean.
/// Parallel (oneTBB).
/// @throws InputError: a mesh, which has no lattice; one of more voxels than the limits allow.
void write_volume_on_input(const std::string& path, const VoxelModel& model, VolumeContent content,
                           const InputGeometry& input, const InputLimits& limits = {});

}  // namespace sulcus
