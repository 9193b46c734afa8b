#include <array>
#include <cmath>
#include <vector>

#include "engine/outcome/goal.hpp"
#include "engine/outcome/voxel_distance.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

namespace {

/// Calls `take(cell)` for each voxel of a set, in the order of squared_distances.
template <class Take>
void for_each_voxel(const VoxelSet& set, const Take& take) {
  for (const std::uint32_t leaf : set.leaves()) {
    const Cell first = set.grid().leaf_origin(leaf);
    for_each_voxel(set.voxels(leaf), [&](int place) { take(first + cell_in_leaf(place)); });
  }
}

bool beside(const VoxelSet& set, const Cell& c) {
  static const std::array<Cell, 6> kSteps{Cell(1, 0, 0),  Cell(-1, 0, 0), Cell(0, 1, 0),
                                          Cell(0, -1, 0), Cell(0, 0, 1),  Cell(0, 0, -1)};
  for (const Cell& step : kSteps) {
    if (set.contains(c + step)) return true;
  }
  return false;
}

}  // namespace

VoxelValues goal_distances(const VoxelModel& now, const VoxelSet& removed, const VoxelSet& target) {
  const VoxelGrid& grid = now.grid;
  VoxelSet surface(grid), missing(grid), bared(grid);
  for (std::uint32_t leaf = 0; leaf < now.leaves.size(); ++leaf) {
    if (any(now.leaves[leaf])) surface.insert(leaf, surface_of_leaf(now, leaf));
  }
  for_each_voxel(surface, [&](const Cell& c) {
    if (target.contains(c)) {
      missing.insert(c);
    } else if (beside(removed, c)) {
      bared.insert(c);
    }
  });
  VoxelValues distances(grid);
  const auto measure = [&](const VoxelSet& from, const VoxelSet& to, double sign, double less) {
    const std::vector<std::uint32_t> squared = squared_distances(from, to);
    if (squared.empty()) return;
    auto at = squared.begin();
    for_each_voxel(from, [&](const Cell& c) {
      distances[c] =
          static_cast<float>(sign * grid.voxel_m * (std::sqrt(static_cast<double>(*at++)) - less));
    });
  };
  measure(missing, outside_target(now, removed, target), -1.0, 0.0);
  measure(bared, target, 1.0, 1.0);
  return distances;
}

}  // namespace sulcus
