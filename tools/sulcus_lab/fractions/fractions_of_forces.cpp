#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/shapes/molar.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "haptics/contact/evaluate_contact.hpp"
#include "tools/sulcus_lab/fractions/fractions.hpp"
#include "tools/sulcus_lab/pareto/pareto_measurement.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/statistics.hpp"
#include "tools/sulcus_lab/truth/composed_shape.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr double kForceVoxel_m = 34.8e-6;

struct Evaluated {
  std::vector<Vector3d> force_N;
  double ns = 0.0;  // of an evaluation, the least mean of three passes; each right after the same
};

/// What the burr feels at poses where it neither moves nor cuts, with the settings of a scene that
/// names none.
Evaluated evaluate_at(const Workpiece& workpiece, const Burr& burr, std::span<const Pose> poses) {
  const HapticsSettings settings;
  const std::vector<TissueSettings> tissues(1);
  ContactScratch scratch(settings);
  Evaluated all;
  for (int pass = 0; pass < 3; ++pass) {
    all.force_N.clear();
    std::uint64_t ns = 0;
    for (const Pose& pose : poses) {
      evaluate_contact(workpiece, {burr, pose, tissues, settings}, scratch);
      const std::uint64_t begin = thread_cpu_ns();
      const ContactResult result =
          evaluate_contact(workpiece, {burr, pose, tissues, settings}, scratch);
      ns += thread_cpu_ns() - begin;
      all.force_N.push_back(result.wrench.force_N);
    }
    const double mean_ns = static_cast<double>(ns) / static_cast<double>(poses.size());
    if (pass == 0 || mean_ns < all.ns) all.ns = mean_ns;
  }
  return all;
}

double angle_deg(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

/// A plane through the scene's origin whose normal leans by `tilt` from +z towards +x.
Vector3d leaning_normal(double tilt) { return {std::sin(tilt), 0.0, std::cos(tilt)}; }

/// A burr of the default scene's size, upright, pressed 0.1 mm into such a plane, along it in x.
/// The way is as long as a terrace of the grid where the grid holds that.
std::vector<Pose> slide_over(double tilt, double radius_m) {
  constexpr double kDepth_m = 0.1e-3, kLongest_m = 4.4e-3, kStep_m = 20e-6;
  const double way_m = std::min(kLongest_m, 2.0 * kForceVoxel_m / std::tan(tilt));
  const Vector3d normal = leaning_normal(tilt);
  const Vector3d along(normal.z(), 0.0, -normal.x());
  const int steps = static_cast<int>(std::ceil(way_m / kStep_m));
  std::vector<Pose> poses;
  for (int s = 0; s <= steps; ++s) {
    const double at_m = way_m * (static_cast<double>(s) / steps - 0.5);
    const Vector3d centre = at_m * along + (radius_m - kDepth_m) * normal;
    poses.push_back({centre - radius_m * Vector3d::UnitZ(), orientation_along(Vector3d::UnitZ())});
  }
  return poses;
}

}  // namespace

std::vector<FractionRow> fractions_of_planes(const FractionOptions& options) {
  const BurrSettings settings;
  const Burr burr = make_burr(settings, kForceVoxel_m);
  VoxelGrid grid;
  grid.cells = {192, 48, 40};
  grid.voxel_m = kForceVoxel_m;
  std::vector<FractionRow> rows;
  for (const double tilt_deg : {0.5, 1.0, 2.0, 3.0}) {
    const double tilt = tilt_deg * kDegree;
    const Vector3d normal = leaning_normal(tilt);
    const ComposedShape plane({half_space(Vector3d::Zero(), normal)},
                              {Vector3d::Constant(-1e-3), Vector3d::Constant(1e-3)});
    const std::vector<Pose> poses = slide_over(tilt, 0.5 * settings.diameter_m);
    FractionRow swing, direction;
    swing.quantity = "force_peak_to_peak_pct";
    swing.wanted = 1.0;
    direction.quantity = "force_direction_deg";
    direction.wanted = 0.1;
    swing.shape = direction.shape = "plane";
    swing.setting = direction.setting = with_number("tilted by %g degrees", tilt_deg);
    for (std::size_t s = 0; s < 2; ++s) {
      options.progress("planes: " + swing.setting + ", " + std::string(kSurfaceNames[s]));
      const Workpiece workpiece{voxelise_implicit(plane, grid, nullptr, {}, kBothSurfaces[s])};
      const Evaluated all = evaluate_at(workpiece, burr, poses);
      std::vector<double> sizes_N;
      for (const Vector3d& force_N : all.force_N) {
        sizes_N.push_back(force_N.norm());
        direction.value[s] = std::max(direction.value[s], angle_deg(force_N, normal));
      }
      swing.value[s] = 100.0 * peak_to_peak(sizes_N) / mean(std::span<const double>(sizes_N));
      swing.ns[s] = direction.ns[s] = all.ns;
    }
    rows.insert(rows.end(), {swing, direction});
  }
  return rows;
}

std::vector<FractionRow> fractions_of_net_force(const FractionOptions& options) {
  // As sulcus-lab pareto has it.
  constexpr double kRadius_m = 20.0 * kForceVoxel_m, kDepth_m = 4.0 * kForceVoxel_m, kNeck_m = 1e-3;
  constexpr int kPoses = 200, kLinesPerVoxel = 4;
  BurrSettings settings;
  settings.diameter_m = 2.0 * kRadius_m;
  const Burr burr = make_burr(settings, kForceVoxel_m);
  settings.field_samples = Eigen::Vector3i(192, 768, 192);
  const Burr fine = make_burr(settings, kForceVoxel_m);
  const Molar molar;
  const ComposedShape shape({side_of(molar)}, molar.bounds());
  VoxelGrid grid;
  grid.cells = Eigen::Vector3i::Constant(512);
  grid.voxel_m = kForceVoxel_m;

  FractionRow row;
  row.quantity = "net_force_rms_pct";
  row.shape = "molar";
  row.setting = "200 poses";
  row.wanted = 0.15;
  std::vector<Pose> poses;
  std::vector<Vector3d> truth_N(kPoses);
  for (std::size_t s = 0; s < 2; ++s) {
    options.progress("net force: " + std::string(kSurfaceNames[s]));
    const Workpiece workpiece{voxelise_implicit(molar, grid, nullptr, {}, kBothSurfaces[s])};
    if (s == 0) {
      KnownSurface surface(workpiece, shape);
      const std::vector<PressedPose> pressed =
          pressed_poses(surface, fine, kRadius_m, kDepth_m, kNeck_m, kPoses, 1, HapticsSettings());
      options.progress("net force: the continuous surface");
      tbb::parallel_for(std::size_t{0}, pressed.size(), [&](std::size_t p) {
        truth_N[p] =
            continuum_force(surface, fine, pressed[p].world_from_tool, pressed[p].truth.box_world,
                            TissueSettings().stiffness_N_per_m, kLinesPerVoxel);
      });
      for (const PressedPose& pose : pressed) poses.push_back(pose.world_from_tool);
    }
    const Evaluated all = evaluate_at(workpiece, burr, poses);
    double squares = 0.0;
    for (std::size_t p = 0; p < poses.size(); ++p) {
      squares += (all.force_N[p] - truth_N[p]).squaredNorm() / truth_N[p].squaredNorm();
    }
    row.value[s] = 100.0 * std::sqrt(squares / kPoses);
    row.ns[s] = all.ns;
  }
  return {row};
}

}  // namespace sulcus::lab
