#pragma once

#include <string>

#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

/// Reads NIfTI-1 and NIfTI-2 (.nii, or .hdr and .img beside each other; each also packed by gzip)
/// [nifti1.h, nifti2.h]. The place is sform's where it has a code, else qform's, else along the
/// axes; what of these disagrees is told in `warnings`. Lengths are what xyzt_units says; mm, with
/// a warning, where it says nothing. Grey values are scaled by scl_slope and scl_inter.
/// @throws InputError, see read_medical_volume.
MedicalVolume read_nifti_volume(const std::string& path, const InputLimits& limits);

}  // namespace sulcus
