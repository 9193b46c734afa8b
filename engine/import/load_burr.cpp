#include "engine/import/load_burr.hpp"

#include <optional>
#include <utility>

#include "engine/cache/cached_field.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/meshes/mesh_shells.hpp"
#include "engine/tool/burr_mesh.hpp"

namespace sulcus {
namespace {

/// All that the field follows from. Of a mesh it is the triangles as they were read, whatever the
/// file they came in.
Hash128 key_of(const BurrSettings& settings, const FieldGrid& grid, const TriangleMesh* mesh_tool) {
  // A setting that is added does not compile until it has a place here.
  const auto& [shape, file, diameter_m, length_m, speed, ratio, samples, spacing_m, reference_m,
               material, grit, worn_m, unit] = settings;
  Hash128Stream key = LoadCache::key_of(CacheKind::kField);
  key.add(grid.samples).add(grid.origin_tool).add(grid.spacing_m);
  key.add(mesh_tool != nullptr);
  if (!mesh_tool) return key.add(shape).add(diameter_m).add(length_m).result();
  key.add(mesh_tool->positions.size()).add(mesh_tool->triangles.size());
  key.add_bytes(mesh_tool->positions.data(),
                mesh_tool->positions.size() * sizeof mesh_tool->positions[0]);
  key.add_bytes(mesh_tool->triangles.data(),
                mesh_tool->triangles.size() * sizeof mesh_tool->triangles[0]);
  return key.result();
}

}  // namespace

Burr load_burr(const Scene& scene, LoadCache* cache) {
  const BurrSettings& settings = scene.burr;
  const double voxel_m = scene.workpiece.voxel_m;
  FieldSource source = make_field;
  if (cache && cache->keeps()) {
    source = [&](const FieldGrid& grid, const TriangleMesh* mesh_tool, const auto& make) {
      const Hash128 key = key_of(settings, grid, mesh_tool);
      const FieldMirrors mirrors = mesh_tool ? FieldMirrors::kNone : FieldMirrors::kXAndZ;
      if (auto field = read_cached_field(*cache, key, grid, mirrors)) return std::move(*field);
      DistanceField field = make();
      write_cached_field(*cache, key, field);
      return field;
    };
  }
  if (settings.shape != BurrShape::kFile) return make_burr(settings, voxel_m, scene.file, source);
  const TriangleMesh mesh = read_mesh(settings.file, scene.limits, metres_of(settings.unit));
  const auto [grid, positions_index] = lattice_about(mesh);
  check_shells(mesh, grid, positions_index, settings.file);
  return make_burr(settings, voxel_m, tool_from_file(mesh), scene.file, source);
}

}  // namespace sulcus
