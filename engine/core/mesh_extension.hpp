#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

namespace sulcus {

/// The extension of a file's name, with its dot, in lower case.
inline std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// Whether a file is a mesh, by its name: .stl, .obj and .ply (in any case).
inline bool is_mesh_file(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".stl" || extension == ".obj" || extension == ".ply";
}

}  // namespace sulcus
