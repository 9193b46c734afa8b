#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "engine/core/units.hpp"
#include "engine/scene/scene.hpp"
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

/// A solid by a function of a place, m from the scene's origin, that is zero or less in it.
struct LawSolid {
  std::function<double(const Eigen::Vector3d&)> value;
  double steepest = 1.0;  // change of the value along a metre, at most
};
/// Its voxels in a grid of `size_m` at least.
VoxelModel law_voxels(const Eigen::Vector3d& size_m, double voxel_m, SurfaceKind surface,
                      const LawSolid& solid);

/// Each voxel of `from` with its level where `to(cell)` says, in an empty model of the same
/// surface.
void put_voxels(const VoxelModel& from, const std::function<Cell(const Cell&)>& to,
                VoxelModel& model);
/// What is solid, by how much of each voxel is filled: of all tissues, or of one.
double filled_voxels(const VoxelModel& model);
double filled_voxels(const VoxelModel& model, std::uint8_t tissue);

/// All shapes, by name: box (an edge along the grid), tilted_box (one that is not), plane, blob,
/// groove (60 degrees), ridge (60 degrees), wall (0.1 mm), molar (a cusp).
std::span<const std::string_view> law_shape_names();
/// One of them; 2.8 mm wide.
LawShape law_shape(std::string_view name, SurfaceKind surface = SurfaceKind::kBinary,
                   double voxel_m = kLawVoxel_m);

/// A V in the middle of whose faces a ball of the burr's radius is centred at the origin, so that
/// it is `depth_m` in each. `bisector`: unit, out of it; `across`: unit, square to it and to the V.
VoxelModel law_groove(double angle, double depth_m, const Eigen::Vector3d& bisector,
                      const Eigen::Vector3d& across, SurfaceKind surface);

/// The middle of the burr's ball where it first touches when it comes down the shape's line, moved
/// aside by `offset_m`. By brute force over all voxels.
Eigen::Vector3d touching_centre(const LawShape& shape,
                                const Eigen::Vector3d& offset_m = Eigen::Vector3d::Zero());

}  // namespace sulcus::lab
