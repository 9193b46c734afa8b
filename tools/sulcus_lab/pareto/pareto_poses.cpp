#include "tools/sulcus_lab/pareto/pareto_poses.hpp"

#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"
#include "engine/scene/trajectory.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr double kLargestTilt = 30.0 * kDegree;

/// Numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

std::vector<Cell> surface_above(const Workpiece& workpiece, double lowest_z_m) {
  const VoxelGrid& grid = workpiece.grid();
  std::vector<Cell> cells;
  for (std::uint32_t leaf = 0; leaf < grid.leaf_count(); ++leaf) {
    const Cell origin = grid.leaf_origin(leaf);
    for_each_voxel(workpiece.surface(leaf), [&](int place) {
      const Cell cell = origin + cell_in_leaf(place);
      if (grid.centre_world(cell).z() > lowest_z_m) cells.push_back(cell);
    });
  }
  return cells;
}

/// Evenly over the area: a plane with the normal n has max |n_a| surface voxels to a voxel's face,
/// so that many more of them are passed over.
Cell random_voxel(KnownSurface& surface, const std::vector<Cell>& cells, Random& random) {
  while (true) {
    const auto at = static_cast<std::size_t>(random.uniform() * static_cast<double>(cells.size()));
    const Vector3d normal = surface.foot(cells[at]).normal;
    if (random.uniform() * std::numbers::sqrt3 * normal.cwiseAbs().maxCoeff() < 1.0) {
      return cells[at];
    }
  }
}

/// Evenly over the cap of directions within the largest tilt.
Vector3d tilted(const Vector3d& normal, Random& random) {
  const double cosine = 1.0 - random.uniform() * (1.0 - std::cos(kLargestTilt));
  const double azimuth = 2.0 * std::numbers::pi * random.uniform();
  const Vector3d u = normal.unitOrthogonal();
  const Vector3d side = std::cos(azimuth) * u + std::sin(azimuth) * normal.cross(u);
  return cosine * normal + std::sqrt(1.0 - cosine * cosine) * side;
}

}  // namespace

std::vector<PressedPose> pressed_poses(KnownSurface& surface, const Burr& burr,
                                       double head_radius_m, double depth_m, double lowest_z_m,
                                       int count, std::uint64_t seed,
                                       const HapticsSettings& settings) {
  const std::vector<Cell> cells = surface_above(surface.workpiece(), lowest_z_m);
  ContactScratch scratch(settings);
  Random random(seed);
  std::vector<PressedPose> poses;
  while (static_cast<int>(poses.size()) < count) {
    const ComposedShape::Foot foot = surface.foot(random_voxel(surface, cells, random));
    const Vector3d axis = tilted(foot.normal, random);
    const auto pose_at = [&](double lift_m) {
      const Vector3d centre = foot.point + (head_radius_m - depth_m + lift_m) * foot.normal;
      return Pose{centre - head_radius_m * axis, orientation_along(axis)};
    };
    PressedPose pressed{pose_at(0.0), {}};
    // Lifting by what is too deep is never too much, and nearly enough where the walls are not
    // steep; the steepest of fissures take some rounds.
    double lift_m = 0.0;
    for (int round = 0; round < 60; ++round) {
      pressed.world_from_tool = pose_at(lift_m);
      pressed.truth = true_force(surface, burr, pressed.world_from_tool, settings, scratch);
      const double excess_m = pressed.truth.deepest_m - depth_m;
      if (excess_m < 0.01 * surface.workpiece().grid().voxel_m) break;
      lift_m += excess_m;
    }
    poses.push_back(std::move(pressed));
  }
  return poses;
}

}  // namespace sulcus::lab
