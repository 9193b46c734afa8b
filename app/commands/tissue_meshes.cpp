#include "app/commands/tissue_meshes.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <set>
#include <vector>

#include "app/terminal/terminal.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/surface/surface_mesh.hpp"

namespace sulcus {

namespace {

/// A tissue's name as a part of a file's: a scene from elsewhere must name no other folder.
std::string file_part(std::string name) {
  constexpr std::size_t kLongest = 64;
  std::ranges::replace_if(
      name, [](unsigned char c) { return c < ' ' || c == '/' || c == '\\' || c == 127; }, '_');
  return name.substr(0, kLongest);
}

}  // namespace

void write_tissue_meshes(const std::string& file, const VoxelModel& model,
                         std::span<const TissueSettings> tissues,
                         const Eigen::Affine3d& space_from_world) {
  const std::filesystem::path path(file);
  std::vector<TriangleMesh> meshes = tissue_surfaces(model, tissues.size());
  std::set<std::string> taken;
  for (std::size_t t = 0; t < meshes.size(); ++t) {
    std::string name = file_part(tissues[t].name);
    if (!taken.insert(name).second) name += "_" + std::to_string(t + 1);
    taken.insert(name);
    if (meshes[t].triangles.empty()) {
      say("%s: no voxel left\n", name.c_str());
      continue;
    }
    std::filesystem::path one = path;
    one.replace_filename(path.stem().string() + "_" + name + path.extension().string());
    transform(space_from_world, meshes[t]);
    write_mesh(one.string(), meshes[t]);
    say("%s: %zu triangles\n", one.string().c_str(), meshes[t].triangles.size());
  }
}

}  // namespace sulcus
