#pragma once

#include <span>
#include <string>

#include "engine/core/input_limits.hpp"
#include "engine/import/itk_volume_io.hpp"

namespace sulcus {

/// PNG files, a slice each, as a volume of unknown spacing: grey values of 8 or 16 bits as they
/// stand in the file, whatever it says of gamma or transparency. Every slice has the size and the
/// depth of the first. Through libpng itself, so that a size is seen before memory is taken.
/// @throws InputError.
ItkVolume read_png_volume(std::span<const std::string> files, const InputLimits& limits);

}  // namespace sulcus
