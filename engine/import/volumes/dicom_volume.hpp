#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

/// Reads the frames of DICOM files of one series, plain and enhanced [DICOM PS3.3, C.7.6.2,
/// C.7.6.16]. Each frame lies where the file puts it: by a position of its own, else by
/// GridFrameOffsetVector or SpacingBetweenSlices along the normal. They are put in order along the
/// normal, upward, and where they lie is the third axis, sheared where a gantry was tilted; no
/// frame lies more than 0.06 mm, or a tenth of a step, beside its own position. Grey values are
/// rescaled, of each frame by its own slope; MONOCHROME1 is a matter of display.
///
/// What is not said leaves `spacing_known` false: PixelSpacing; how far frames lie apart, where
/// they go by InstanceNumber. `name`: file or folder, for messages.
/// @throws InputError: damaged, several series, frames that are not alike or do not lie in even
/// steps, of each which one and where.
MedicalVolume read_dicom_volume(const std::string& name, std::span<const std::string> files,
                                const InputLimits& limits);

/// The DICOM files among those of a folder.
struct DicomSlices {
  std::vector<std::string> files;
  std::vector<std::string> warnings;  // what has a slice's extension and is none
};
/// @throws InputError: a file named .dcm that is none.
DicomSlices dicom_slices(std::span<const std::string> files);

}  // namespace sulcus
