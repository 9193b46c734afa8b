#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact/normal_cache.hpp"
#include "haptics/removal.hpp"

namespace sulcus {

/// A solid of the scene in a grid of its own, which stays where it is: the workpiece, or a
/// neighbouring tooth or a jaw beside it. All are felt; those with `removal` are cut.
struct Body {
  /// The workpiece: its grid's space is the world.
  Body(const Scene& scene, Workpiece start);
  Body(const Scene& scene, const BodySettings& settings, Workpiece start);

  Pose world_from_grid;
  std::size_t first_tissue = 0;  // of the scene's, that its label 0 is
  Workpiece solid;
  std::optional<NormalCache> normal_cache;  // with haptics.keep_normals only
  std::optional<RemovalState> removal;      // of one that can be cut, with [cutting] only
  /// Its grid, and of a body beside the workpiece a voxel more, which may be larger than that's.
  Eigen::AlignedBox3d bounds_world;
  /// The leaves that had a voxel at the start, and half a voxel about them: outside there is none.
  Eigen::AlignedBox3d solid_bounds_world;
  // Damage, which no later tick depends on. The workpiece's is neither hashed nor saved.
  std::uint64_t touched_ticks = 0;
  double peak_force_N = 0.0;

  /// From the world to the grid's space. Where the two are the same every bit stays as it is, the
  /// sign of a zero too, which a product with the identity would lose.
  Pose grid_from(const Pose& world_from_tool) const;
  bool is_in_world() const;  // the two are the same

  /// With all of it, the voxels too.
  std::uint64_t hash() const;

 private:
  void make_cuttable(const CuttingSettings& cutting);
};

/// Body 0, the workpiece, and one for each [[body]] of a scene, `starts` in this order.
std::vector<Body> make_bodies(const Scene& scene, std::vector<Workpiece> starts);

}  // namespace sulcus
