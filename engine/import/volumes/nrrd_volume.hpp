#pragma once

#include <string>

#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

/// Reads NRRD 1 to 5 (.nrrd, or .nhdr with data files of its own) [teem, "Definition of NRRD File
/// Format"]: encodings raw, text, hex, gzip and bzip2; every named space, turned to +x left, +y
/// posterior, +z superior; units of the space or of the axes, mm where none are named; axes of one
/// sample that are not of space are left out.
/// @throws InputError, see read_medical_volume.
MedicalVolume read_nrrd_volume(const std::string& path, const InputLimits& limits);

}  // namespace sulcus
