#pragma once

#include <span>
#include <string>

#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

/// PNG files, a slice each, as a volume of unknown spacing: grey values of 1 to 16 bits as they
/// stand in the file, whatever it says of gamma or transparency. Every slice has the size and the
/// depth of the first. Through libpng itself, so that a size is seen before memory is taken.
/// @throws InputError.
MedicalVolume read_png_volume(std::span<const std::string> files, const InputLimits& limits);

}  // namespace sulcus
