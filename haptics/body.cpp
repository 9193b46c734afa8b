#include "haptics/body.hpp"

#include <array>
#include <utility>

#include "engine/core/hash.hpp"
#include "haptics/state_fields.hpp"

namespace sulcus {

namespace {

Eigen::AlignedBox3d placed(const Eigen::AlignedBox3d& box, const Pose& world_from_grid) {
  const Eigen::Isometry3d place =
      Eigen::Translation3d(world_from_grid.position) * world_from_grid.orientation;
  return box.transformed(place);
}

Eigen::AlignedBox3d bounds_of(const VoxelGrid& grid, double margin_m, const Pose& world_from_grid) {
  const Eigen::Vector3d half = (0.5 * grid.voxel_m * grid.cells.cast<double>()).array() + margin_m;
  return placed({-half, half}, world_from_grid);
}

Eigen::AlignedBox3d solid_bounds_of(const Workpiece& solid, const Pose& world_from_grid) {
  const VoxelGrid& grid = solid.grid();
  // From a voxel before the first one's centre to one behind the last one's.
  const Eigen::Vector3d before = grid.centre_world(solid.columns().lower()).array() - grid.voxel_m;
  return placed({before, grid.centre_world(solid.columns().upper())}, world_from_grid);
}

}  // namespace

Body::Body(const Scene& scene, Workpiece start)
    : solid(std::move(start)),
      bounds_world(bounds_of(solid.grid(), 0.0, {})),
      solid_bounds_world(solid_bounds_of(solid, {})) {
  if (uses_normal_cache(scene.haptics)) normal_cache.emplace(solid.grid(), scene.haptics);
  if (scene.cutting) make_cuttable(*scene.cutting);
}

Body::Body(const Scene& scene, const BodySettings& settings, Workpiece start)
    : world_from_grid(settings.world_from_grid),
      first_tissue(settings.tissue.value_or(0)),
      solid(std::move(start)),
      bounds_world(bounds_of(solid.grid(), solid.grid().voxel_m, world_from_grid)),
      solid_bounds_world(solid_bounds_of(solid, world_from_grid)) {
  if (uses_normal_cache(scene.haptics)) normal_cache.emplace(solid.grid(), scene.haptics);
  if (scene.cutting && settings.cuttable) make_cuttable(*scene.cutting);
}

void Body::make_cuttable(const CuttingSettings& cutting) {
  constexpr std::uint32_t kVoxelsOfLeaf = 64;  // of a leaf that a cut goes through, about
  removal.emplace(cutting);
  solid.reserve_fills(static_cast<std::uint32_t>(cutting.max_cut_voxels) / kVoxelsOfLeaf);
}

Pose Body::grid_from(const Pose& world_from_tool) const {
  return is_in_world() ? world_from_tool : inverse(world_from_grid) * world_from_tool;
}

bool Body::is_in_world() const {
  return world_from_grid.position.isZero(0.0) &&
         world_from_grid.orientation.coeffs() == Eigen::Quaterniond::Identity().coeffs();
}

std::uint64_t Body::hash() const {
  std::array<std::uint64_t, 3> parts{solid.hash()};
  if (removal) parts[1] = removal->hash();
  parts[2] = fields::hash_of([this](auto& archive) { fields::damage(archive, *this); });
  return hash_bytes(parts.data(), sizeof(parts));
}

std::vector<Body> make_bodies(const Scene& scene, std::vector<Workpiece> starts) {
  std::vector<Body> bodies;
  bodies.reserve(starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    i == 0 ? bodies.emplace_back(scene, std::move(starts[i]))
           : bodies.emplace_back(scene, scene.bodies[i - 1], std::move(starts[i]));
  }
  return bodies;
}

}  // namespace sulcus
