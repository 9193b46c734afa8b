#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Geometry>

#include "engine/import/volumes/medical_volume.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/grid.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What the import of a volume found and left out, in voxels of the file.
struct VolumeImportReport {
  float least = 0.0f, greatest = 0.0f;   // grey values in the file
  std::uint64_t solid_voxels = 0;        // kept
  std::uint32_t dropped_components = 0;  // specks beside the largest one
  std::uint64_t dropped_voxels = 0;
  bool resampled = true;  // false: the grid's voxels are the file's
  // From where `settings` put it to where it lies, since voxels of the file stay whole; m.
  Eigen::Vector3d beside_m = Eigen::Vector3d::Zero();
  // Rigid; the file's space is that of `origin_m`, its spacing what was used.
  Eigen::Affine3d file_from_world = Eigen::Affine3d::Identity();
};

/// Resamples a volume to the cubic voxels of `grid`: solid is what is at or above
/// `settings.solid_above`, or, without it, above 0 (a mask or labels).
///
/// - Grey values: weighted by the cubic B-spline kernel, which smooths by 0.58 voxels of the file.
///   A spline through the values, or a linear interpolation, hands the scanner's noise and banding
///   on to the surface, where they are felt. Its price: a surface of radius R moves inwards by
///   spacing^2 / (3 R), 6 um at a cusp of 1 mm in a file of 0.13 mm; and where `solid_above` is not
///   half way up a blurred step, towards the end that it is nearer to, of a CT of a tooth 0.03 to
///   0.07 of its voxels outwards (`sulcus-lab fractions --measure ct`). Of the 6-connected
///   components only the largest is kept; the rest is noise or a neighbour and becomes air.
/// - Mask: every component is kept. A mask of voxels more than 1.5 times as large as the grid's is
///   smoothed by the same kernel (edges round within one voxel of the file), a finer one is
///   interpolated linearly; the surface is where either says 0.5.
/// - Where the file's voxels are the grid's own (size and axes), nothing is resampled, and the
///   placement is rounded to whole voxels, so that an exported volume comes back as it was. A solid
///   of an odd number of them along an axis lies half a voxel beside the middle of a grid:
///   `beside_m` tells.
///
/// The centre of the solid's bounding box, along the file's axes, comes to the scene's origin; then
/// the solid is turned by `settings.rotation` and moved by `settings.position_m`. `clipped` is set
/// where it reaches beyond the grid.
///
/// Tissues: of each voxel the one with the highest `above` that is not above its grey value, else
/// the first without `above`, else the one with the lowest. Grey values near the surface are those
/// from under the partial-volume shell (tissue_values.hpp). A mask's voxels have the file's nearest
/// value; where tissues have a `label` it is that value itself (the others are taken out before,
/// volume_part.hpp). One tissue: no labels.
///
/// With `settings.surface` kFractions the voxels next to the surface of grey values are filled as
/// the interpolated greys say (grey_fills.hpp), and one that is filled at all is solid. A mask's
/// voxels are all full.
///
/// Parallel (oneTBB); the result does not depend on the number of threads.
/// @throws InputError: no solid, none of it in the grid, spacing neither in the file nor in
/// `settings`.
VoxelModel voxelise_volume(const MedicalVolume& volume, const VoxelGrid& grid,
                           const WorkpieceSettings& settings,
                           std::span<const TissueSettings> tissues,
                           VolumeImportReport* report = nullptr);

}  // namespace sulcus
