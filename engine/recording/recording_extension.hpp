#pragma once

#include <string>

#include "engine/core/mesh_extension.hpp"  // lower_extension

namespace sulcus {

/// Whether a file is a recording, by its name: .h5 and .hdf5 (in any case).
inline bool is_recording_file(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".h5" || extension == ".hdf5";
}

}  // namespace sulcus
