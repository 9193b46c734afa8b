#pragma once

#include <string>

#include "engine/import/volumes/medical_volume.hpp"
#include "tools/sulcus_lab/truth/truth_shapes.hpp"

namespace sulcus::lab {

/// The voxels of a volume as they are, for measuring: solid where a value is above 0, indices those
/// of the file, spacing of no account. The grid is padded with empty voxels to multiples of 8.
/// InputError beyond 1024 voxels along an axis.
VoxelModel model_of_mask(const MedicalVolume& volume);

/// The same voxels with fractions: the levels of a volume of the mask's size, 0 to 255. What the
/// mask has must have a level. InputError on another size or value.
VoxelModel model_of_fills(const MedicalVolume& levels, const VoxelModel& mask);

/// Normals of some of a model's surface voxels from a table with the header `i,j,k,nx,ny,nz,zone`:
/// indices of the voxel, outward unit normal in index space (1 % off at most; it is scaled to
/// length 1), and a word of letters, digits, '_', '-' or '.' to group by. InputError, with the
/// line, on anything else, on a voxel that is not of the surface and on one listed twice.
TruthShape read_truth_file(const std::string& file, VoxelModel model, std::string name);

}  // namespace sulcus::lab
