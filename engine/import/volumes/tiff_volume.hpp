#pragma once

#include <span>
#include <string>

#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

/// Reads the pages of TIFF files (BigTIFF, too), one behind the other, as the slices of a volume:
/// grey, of up to 64 bits, in strips or tiles, packed without loss, turned by their orientation.
/// Values stay as they are stored where 0 is white, which is a matter of display. Only ImageJ and
/// OME write how large a voxel is; what else a TIFF has is the size of a print.
/// @throws InputError: damaged or of another form, pages that are not alike, larger than the limits
/// allow.
MedicalVolume read_tiff_volume(std::span<const std::string> files, const InputLimits& limits);

}  // namespace sulcus
