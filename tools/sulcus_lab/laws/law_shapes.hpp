#pragma once

#include <cmath>
#include <span>
#include <string_view>

#include "engine/core/units.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus::lab {

inline constexpr double kLawVoxel_m = 34.8e-6;
inline constexpr double kLawRadius_m = 0.5e-3;  // of the round burr

/// A solid of voxels in a grid that is a cube, and a line down to it.
struct LawShape {
  VoxelModel model;
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  // near its surface, world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // out of it there, about
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();  // unit, to the normal and to its edge
  Eigen::Vector3d along() const { return normal.cross(across); }
};

/// Voxels of a cube, `size_m` wide at least, whose centre p, m from the scene's origin, is
/// solid(p).
template <class Solid>
VoxelModel law_solid(const Eigen::Vector3d& size_m, double voxel_m, const Solid& solid) {
  VoxelModel model;
  model.grid.cells = 8 * (size_m.array() / (8.0 * voxel_m) - 1e-6).ceil().cast<int>().matrix();
  model.grid.voxel_m = voxel_m;
  model.leaves.resize(model.grid.leaf_count());
  for_each_cell(Cell::Zero(), model.grid.cells, [&](const Cell& c) {
    if (solid(model.grid.centre_world(c))) model.set(c, true);
  });
  return model;
}

/// All shapes, by name: box (an edge along the grid), tilted_box (one that is not), plane, blob,
/// groove (60 degrees), ridge (60 degrees), wall (0.1 mm), molar (a cusp).
std::span<const std::string_view> law_shape_names();
/// One of them; 2.8 mm wide.
LawShape law_shape(std::string_view name, double voxel_m = kLawVoxel_m);

/// A V in the middle of whose faces a ball of the burr's radius is centred at the origin, so that
/// it is `depth_m` in each. `bisector`: unit, out of it; `across`: unit, square to it and to the V.
VoxelModel law_groove(double angle, double depth_m, const Eigen::Vector3d& bisector,
                      const Eigen::Vector3d& across);

/// The middle of the burr's ball where it first touches when it comes down the shape's line, moved
/// aside by `offset_m`. By brute force over all voxels.
Eigen::Vector3d touching_centre(const LawShape& shape,
                                const Eigen::Vector3d& offset_m = Eigen::Vector3d::Zero());

}  // namespace sulcus::lab
