#include "engine/import/meshes/mesh_file.hpp"

#include <filesystem>
#include <system_error>

#include "engine/core/error.hpp"
#include "engine/import/meshes/mesh_readers.hpp"

namespace sulcus {

namespace {

TriangleMesh read_in_millimetres(const std::string& path, const InputLimits& limits) {
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

}  // namespace

TriangleMesh read_mesh(const std::string& path, const InputLimits& limits, double unit_m) {
  TriangleMesh mesh = read_in_millimetres(path, limits);
  if (unit_m == kMillimetre) return mesh;
  constexpr float kFarthest_m = 1e3f;
  const auto scale = static_cast<float>(unit_m / kMillimetre);
  for (Eigen::Vector3f& p : mesh.positions) {
    p *= scale;
    if ((p.array().abs() > kFarthest_m).any()) {
      throw InputError(path, "unit", "a coordinate beyond 1 km", "a smaller unit");
    }
  }
  return mesh;
}

}  // namespace sulcus
