#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

// A reader for each format; read_medical_volume chooses among them.

/// Reads NRRD 1 to 5 (.nrrd, or .nhdr with data files of its own) [teem, "Definition of NRRD File
/// Format"]: encodings raw, text, hex, gzip and bzip2; every named space, turned to +x left, +y
/// posterior, +z superior; units of the space or of the axes, mm where none are named; axes of one
/// sample that are not of space are left out.
/// @throws InputError, see read_medical_volume.
MedicalVolume read_nrrd_volume(const std::string& path, const InputLimits& limits);

/// Reads MetaImage (.mha, or .mhd with data files of its own) [MetaIO, "MetaImage documentation"]:
/// binary or text, plain or as a zlib stream, in one file or one a slice. Lengths are mm unless
/// DistanceUnits says another; the sides are those of TransformMatrix, else of
/// AnatomicalOrientation.
/// @throws InputError, see read_medical_volume.
MedicalVolume read_meta_image_volume(const std::string& path, const InputLimits& limits);

/// Reads NIfTI-1 and NIfTI-2 (.nii, or .hdr and .img beside each other; each also packed by gzip)
/// [nifti1.h, nifti2.h]. The place is sform's where it has a code, else qform's, else along the
/// axes; what of these disagrees is reported in `warnings`. Lengths are what xyzt_units says; mm,
/// with a warning, where it says nothing. Grey values are scaled by scl_slope and scl_inter.
/// @throws InputError, see read_medical_volume.
MedicalVolume read_nifti_volume(const std::string& path, const InputLimits& limits);

/// Reads the pages of TIFF files (BigTIFF, too), one behind the other, as the slices of a volume:
/// grey, of up to 64 bits, in strips or tiles, packed without loss, turned by their orientation.
/// Values stay as they are stored where 0 is white, which is a matter of display. Only ImageJ and
/// OME write how large a voxel is; what else a TIFF has is the size of a print.
/// @throws InputError: damaged or of another form, pages that are not alike or no slices in order,
/// as ImageJ, OME and tifffile say it, larger than the limits allow.
MedicalVolume read_tiff_volume(std::span<const std::string> files, const InputLimits& limits);

/// PNG files, a slice each, as a volume of unknown spacing: grey values of 1 to 16 bits as they
/// stand in the file, whatever it says of gamma or transparency. Every slice has the size and the
/// depth of the first. Through libpng itself, so that a size is seen before memory is taken.
/// @throws InputError.
MedicalVolume read_png_volume(std::span<const std::string> files, const InputLimits& limits);

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
