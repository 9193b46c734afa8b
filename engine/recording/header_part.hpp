#pragma once

#include <cstdint>
#include <string>

#include "engine/recording/hdf5_handle.hpp"
#include "engine/recording/recording_header.hpp"

namespace sulcus {

// The attributes of a recording's file, as the layout has them. All throw Hdf5Error.

void write_header(const Hdf5Handle& file, const RecordingHeader& header);

/// @throws InputError where `file` is no recording, or one of a newer version; Hdf5Error where it
/// is damaged. `file_bytes` bounds what it can hold.
RecordingHeader read_header(const Hdf5Handle& file, const std::string& path,
                            std::uint64_t file_bytes);

}  // namespace sulcus
