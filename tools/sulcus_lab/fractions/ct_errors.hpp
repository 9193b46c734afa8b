#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "engine/volume/voxel_model.hpp"
#include "tools/sulcus_lab/fractions/fraction_row.hpp"
#include "tools/sulcus_lab/truth/grey_spline.hpp"

namespace sulcus::lab {

/// A volume of grey values, as a scene names one.
struct CtFile {
  std::string path;
  double solid_above = 0.0;  // grey value
};

/// A solid as a scene loads it.
struct CtModel {
  VoxelModel model;
  Eigen::Affine3d lattice_from_index;  // of the file's lattice and the model's grid
  /// Edge of a voxel in those of the file.
  double steps_per_voxel() const { return lattice_from_index.linear().col(0).norm(); }
};
/// In voxels of the file's own, or in those of so many to one along each axis. InputError as the
/// import; also where the file's voxels are not cubes.
CtModel load_ct(const CtFile& file, SurfaceKind surface, int finer = 1);

/// A surface voxel, and by how much what ldm says at NS 6 of its surface is off the truth.
struct CtVoxel {
  Cell cell;
  double curvature = 0.0;  // of the smoothed truth, 1 / voxel: noise makes none there
  /// How much further out than the true surface the fitted one lies, voxels: both from the voxel's
  /// centre, each along its own normal.
  double offset_error = 0.0;
  double normal_error_deg = 0.0;
};

/// Errors of one surface against one truth. Left out are voxels at which that says nothing: `thin`:
/// another face of it within kThin voxels; `flat`: grey values change by less than a tenth of what
/// they do at the median surface voxel, or no closest point was found; `undefined`: ldm found no
/// normal.
struct CtErrors {
  std::vector<CtVoxel> voxels;
  std::size_t thin = 0, flat = 0, undefined = 0;
};
inline constexpr double kThin = 3.0;

/// In the order of GreyTruth.
inline constexpr std::array<std::string_view, 2> kCtTruthNames{"through", "smoothed"};

/// Of each truth those of both surfaces, at the surface voxels of each: where it is felt. The
/// smoothed truth is the surface that the import means (grey_fills.hpp); the one through the values
/// is where the scan says that it is. Parallel; the result does not depend on the number of
/// threads. InputError as load_ct.
using CtErrorsOfAll = std::array<std::array<CtErrors, 2>, 2>;
CtErrorsOfAll ct_errors(const CtFile& file, int finer,
                        const std::function<void(const std::string&)>& progress);

/// A bar of the histogram of an error: the share of the voxels, %, of which it is from `from` to
/// before `to`.
struct CtBin {
  std::string_view quantity;  // "offset_error_voxels", "normal_error_deg"
  std::string_view truth;     // kCtTruthNames
  double from = 0.0, to = 0.0;
  OfSurfaces share_pct{};
};
/// What lies beyond +- 0.5 voxels or 24 degrees is in none.
std::vector<CtBin> ct_bins(const CtErrorsOfAll& errors);

}  // namespace sulcus::lab
