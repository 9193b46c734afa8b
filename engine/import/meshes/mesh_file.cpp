#include "engine/import/meshes/mesh_file.hpp"

#include <filesystem>
#include <system_error>

#include "engine/core/error.hpp"
#include "engine/import/meshes/mesh_readers.hpp"

namespace sulcus {

TriangleMesh read_mesh(const std::string& path, const InputLimits& limits) {
  namespace fs = std::filesystem;
  const std::string extension = lower_extension(path);
  if (!is_mesh_file(path)) {
    throw InputError(path, "", "the extension \"" + extension + "\"", ".stl, .obj or .ply");
  }
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path, "", "no such file", "a mesh");
  if (!fs::is_regular_file(path, error)) throw InputError(path, "", "no file", "a mesh");
  if (fs::file_size(path, error) == 0 || error) {
    throw InputError(path, "", "an empty file", "a mesh");
  }
  if (extension == ".stl") return read_stl(path, limits);
  if (extension == ".obj") return read_obj(path, limits);
  return read_ply(path, limits);
}

}  // namespace sulcus
