#pragma once

#include <filesystem>
#include <string>

#include "engine/core/ascii.hpp"

namespace sulcus {

/// The extension of a file's name, with its dot, in lower case.
inline std::string lower_extension(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

/// Whether a file is a mesh, by its name: .stl, .obj and .ply (in any case).
inline bool is_mesh_file(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".stl" || extension == ".obj" || extension == ".ply";
}

}  // namespace sulcus
