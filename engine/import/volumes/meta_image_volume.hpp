#pragma once

#include <string>

#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

/// Reads MetaImage (.mha, or .mhd with data files of its own) [MetaIO, "MetaImage documentation"]:
/// binary or text, plain or as a zlib stream, in one file or one a slice. Lengths are mm unless
/// DistanceUnits says another; the sides are those of TransformMatrix, else of
/// AnatomicalOrientation.
/// @throws InputError, see read_medical_volume.
MedicalVolume read_meta_image_volume(const std::string& path, const InputLimits& limits);

}  // namespace sulcus
