#include "app/pictures/goal_section.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"

namespace sulcus {

std::optional<Section> section_through(const VoxelSet& target, const Viewpoint& from) {
  const Eigen::Vector3d& back = from.back_world;
  if (from.follows_burr || std::hypot(back.x(), back.y()) < 0.5 * back.norm()) return {};
  const VoxelGrid& grid = target.grid();
  Eigen::AlignedBox3d box;
  for (const std::uint32_t leaf : target.leaves()) {
    const Cell first = grid.leaf_origin(leaf);
    for_each_voxel(target.voxels(leaf),
                   [&](int place) { box.extend(grid.centre_world(first + cell_in_leaf(place))); });
  }
  if (box.isEmpty()) return {};
  const int axis = std::abs(back.x()) > std::abs(back.y()) ? 0 : 1;
  constexpr double kRound = 0.01 * kMillimetre;
  return Section{axis, std::round(box.center()[axis] / kRound) * kRound};
}

VoxelModel model_of(const VoxelSet& voxels) {
  VoxelModel model;
  model.grid = voxels.grid();
  model.leaves.resize(model.grid.leaf_count());
  for (const std::uint32_t leaf : voxels.leaves()) model.leaves[leaf] = voxels.voxels(leaf);
  return model;
}

}  // namespace sulcus
