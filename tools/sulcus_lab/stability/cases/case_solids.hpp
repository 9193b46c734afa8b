#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/units.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/stability/rig.hpp"

namespace sulcus::lab {

// What the scripted cases have in common: small solids of voxels about the scene's origin, a round
// burr, and a path that takes it there.

inline constexpr double kCaseVoxel_m = 34.8e-6;
inline constexpr double kCaseVoxel_mm = kCaseVoxel_m / kMillimetre;
inline constexpr double kCaseRadius_m = 0.5e-3;  // of the burr
inline constexpr double kCaseRadius_mm = kCaseRadius_m / kMillimetre;
// Of [coupling] where no device is named.
inline constexpr double kCaseForceLimit_N = CouplingSettings{}.force_limit_N;
inline constexpr double kCaseSpring_N_per_mm =
    CouplingSettings{}.stiffness_N_per_m / kNewtonPerMillimetre;

/// Voxels whose centre p, in voxels from the scene's origin, is solid(p). `cells` are multiples of
/// 8, so that the origin is a corner of eight voxels.
template <class Solid>
VoxelModel solid_where(const Eigen::Vector3i& cells, const Solid& solid) {
  VoxelModel model;
  model.grid.cells = cells;
  model.grid.voxel_m = kCaseVoxel_m;
  model.leaves.resize(model.grid.leaf_count());
  for (int k = 0; k < cells.z(); ++k) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int i = 0; i < cells.x(); ++i) {
        const Eigen::Vector3d p = Cell(i, j, k).cast<double>() - model.grid.origin_index();
        if (solid(p)) model.set({i, j, k}, true);
      }
    }
  }
  return model;
}

struct NamedSolid {
  std::string name;
  VoxelModel model;
};

/// So many voxels thick, its upper face at z = 0.
VoxelModel wall_solid(int voxels);
/// What is not beyond the plane through the origin with a unit normal.
VoxelModel half_space_solid(const Eigen::Vector3d& normal);
/// Two faces of 45 degrees that meet in a ridge along y, `phase` voxels beside the origin.
VoxelModel roof_solid(double phase);
/// The edge along y of a block whose faces lie along the grid, at the origin.
VoxelModel block_edge_solid();
/// One voxel wide and so many high, on nothing; its upper face is at z = 0, its axis at half a
/// voxel in x and y.
VoxelModel column_solid(int voxels);
/// Lone voxels in a square pattern, their upper faces at z = 0, one at half a voxel in x and y.
VoxelModel pins_solid(int spacing);
/// A V along y in which a ball of the burr's radius first touches with its lowest point at z = 0.
/// Its middle lies `phase` voxels beside the origin.
VoxelModel groove_solid(double angle, double phase);
/// A slot along y, so many voxels wide, right through a block whose upper face is at z = 0.
VoxelModel slot_solid(int voxels);
/// Where its middle is in x, m: the origin, or half a voxel beside it.
double slot_middle_m(int voxels);

/// A scene with the cases' burr, which does not turn, for method_scene. `more`: other tables.
std::string case_text(const std::string& more = {});

/// The tip's way through corners, in millimetres, and a rest of so many ticks at the end.
std::vector<Pose> case_path(const std::vector<Eigen::Vector3d>& corners_mm, double speed_mm_per_s,
                            int rest_ticks = 0);
/// On from where a path ends.
void go_on(std::vector<Pose>& path, const Eigen::Vector3d& to_mm, double speed_mm_per_s,
           int rest_ticks = 0);

/// All ticks of a path.
std::vector<Felt> run_path(ContactMethod method, const Scene& scene, const VoxelModel& solid,
                           const std::vector<Pose>& path);

/// Whether the tool is held by a device's spring, so that it stays outside.
bool is_held_outside(ContactMethod method);

/// The furthest that a force along +z falls below what it has been before.
double largest_fall_N(std::span<const Felt> ticks);
/// The largest difference from tick to tick.
double largest_step_N(std::span<const Felt> ticks);
double angle_between_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace sulcus::lab
