#pragma once

#include <cstddef>
#include <string>

#include "app/playback/recorded_run.hpp"

namespace sulcus {

/// Writes the first `rows` ticks of a recording as a table, a row each: mm, N, mN m, us, world
/// axes, quaternions world from tool or device; the force that was asked for where the recording
/// has /port. A scene's [trajectory] takes it as its file, and then follows the device's poses.
/// @throws as WholeFile.
void write_ticks_csv(const std::string& file, const RecordingReader& reader,
                     const RecordedShape& shape, std::size_t rows);

}  // namespace sulcus
