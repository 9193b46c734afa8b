#include "app/window/pointer_pick.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sulcus {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A part of a line, m from where it begins.
struct Stretch {
  double begin = 0.0, end = kNever;

  /// Leaves what of it has `at + gone * by` not below 0.
  void keep(double at, double by) {
    if (by > 0.0) {
      begin = std::max(begin, -at / by);
    } else if (by < 0.0) {
      end = std::min(end, -at / by);
    } else if (at < 0.0) {
      end = -kNever;
    }
  }
};

bool is_met(const VoxelModel& model, const Cell& c) {
  return model.solid(c) && 2 * model.level(c) >= kFullLevel;
}

}  // namespace

/// From voxel to voxel [Amanatides and Woo 1987].
std::optional<PickedPoint> picked_point(const VoxelModel& model, const Pose& world_from_grid,
                                        const SightLine& line, const Eigen::Vector4f& shown_world) {
  const VoxelGrid& grid = model.grid;
  // In index space moved by a half, where voxel (i, j, k) is the cube from there to one further.
  const Eigen::Vector3d from =
      grid.index_from_world(world_from_grid.inverse_point(line.from_world)) +
      Eigen::Vector3d::Constant(0.5);
  const Eigen::Vector3d way = world_from_grid.inverse_direction(line.way_world) / grid.voxel_m;
  Stretch stretch;
  for (int a = 0; a < 3; ++a) {
    stretch.keep(from[a], way[a]);
    stretch.keep(grid.cells[a] - from[a], -way[a]);
  }
  const Eigen::Vector4d shown = shown_world.cast<double>();
  stretch.keep(shown.head<3>().dot(line.from_world) + shown.w(),
               shown.head<3>().dot(line.way_world));
  if (!(stretch.begin < stretch.end)) return {};

  double gone = stretch.begin;
  Cell cell = (from + gone * way).array().floor().cast<int>();
  cell = cell.cwiseMax(0).cwiseMin(grid.cells - Cell::Ones());
  while (gone < stretch.end && grid.contains(cell)) {
    if (is_met(model, cell)) {
      return PickedPoint{line.from_world + gone * line.way_world, cell, model.tissue(cell), gone};
    }
    int axis = 0;
    double next = kNever;
    for (int a = 0; a < 3; ++a) {
      if (way[a] == 0.0) continue;
      const double at = (cell[a] + (way[a] > 0.0 ? 1 : 0) - from[a]) / way[a];
      if (at >= next) continue;
      next = at;
      axis = a;
    }
    cell[axis] += way[axis] > 0.0 ? 1 : -1;
    gone = std::max(gone, next);
  }
  return {};
}

}  // namespace sulcus
