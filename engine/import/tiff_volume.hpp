#pragma once

#include <span>
#include <string>

#include "engine/core/input_limits.hpp"
#include "engine/import/itk_volume_io.hpp"

namespace sulcus {

/// The pages of TIFF files, one file after another, as a volume of unknown spacing: grey values of
/// 8, 16 or 32 bits (whole, signed or float), in strips, of a compression without loss. Every page
/// has the form of the first. Through libtiff itself: ITK 5.2 takes all pages for what the first
/// one says, and reads and writes past the end of its buffers where another is smaller.
/// @throws InputError.
ItkVolume read_tiff_volume(std::span<const std::string> files, const InputLimits& limits);

}  // namespace sulcus
