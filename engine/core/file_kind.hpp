#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>

#include "engine/core/ascii.hpp"

namespace sulcus {

/// The extension of a file's name, with its dot, in lower case; of a packed file with what it
/// holds: .nii.gz.
inline std::string lower_extension(const std::string& name) {
  const std::filesystem::path path(name);
  std::string extension = path.extension().string();
  if (lower_case(extension) == ".gz") extension = path.stem().extension().string() + extension;
  return lower_case(extension);
}

/// Whether a file is a mesh, by its name: .stl, .obj and .ply (in any case).
inline bool is_mesh_file(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".stl" || extension == ".obj" || extension == ".ply";
}

/// Whether a file is a volume, by its name (in any case).
inline bool is_volume_file(const std::string& path) {
  constexpr std::array kEndings{".nrrd", ".nhdr", ".mha", ".mhd",  ".nii", ".nii.gz",
                                ".hdr",  ".img",  ".tif", ".tiff", ".dcm"};
  return std::ranges::find(kEndings, lower_extension(path)) != kEndings.end();
}

/// Whether a file is a recording, by its name: .h5 and .hdf5 (in any case).
inline bool is_recording_file(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".h5" || extension == ".hdf5";
}

}  // namespace sulcus
