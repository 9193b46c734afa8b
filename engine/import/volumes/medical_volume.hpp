#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/core/input_limits.hpp"

namespace sulcus {

/// Grey values on a lattice as a file holds them. The centre of voxel (i, j, k) lies at
/// `origin_m + direction * (spacing_m .* (i, j, k))` in the file's own space (for medical files:
/// the patient's, +x left, +y posterior, +z superior).
struct MedicalVolume {
  std::string file;                                 // for messages
  Eigen::Vector3i sizes = Eigen::Vector3i::Zero();  // voxels
  Eigen::Vector3d spacing_m = Eigen::Vector3d::Constant(1e-3);
  bool spacing_known = true;  // false: the file does not say
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d direction = Eigen::Matrix3d::Identity();  // columns: unit steps along the axes,
                                                            // not always at right angles
  std::vector<float> values;                                // sizes.prod(), x fastest; all finite
  std::vector<std::string> warnings;  // for the user, a line each: what was not as it should be

  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(sizes.x()) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(sizes.y()) * static_cast<std::size_t>(k));
  }
  float at(int i, int j, int k) const { return values[index(i, j, k)]; }
};

/// Reads NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), NIfTI (.nii, .nii.gz, .hdr, .img), TIFF
/// (.tif, .tiff: a stack of grey pages, or a folder of slices in the order of their numbers), PNG
/// (a folder of grey slices) and DICOM (.dcm, or a folder that holds one series; grey values
/// rescaled). What a header states is read or refused, never changed: see the reader of each
/// format. What it does not state leaves `spacing_known` false. Lengths are mm where a format has
/// no unit. Values above all floats become the largest finite one, others that are not finite the
/// smallest, as does what DICOM calls padding, with a warning that counts them. Announced sizes are
/// checked, and compared with the length of the file, before memory is taken.
/// @throws InputError: missing, not of its format, truncated, not 3-dimensional, not scalar, larger
/// than the limits allow, spacing not positive.
MedicalVolume read_medical_volume(const std::string& path, const InputLimits& limits = {});

}  // namespace sulcus
