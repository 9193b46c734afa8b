#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
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

double direction_off_deg(const Vector3d& a, const Vector3d& b) {
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
        direction.value[s] = std::max(direction.value[s], direction_off_deg(force_N, normal));
      }
      swing.value[s] = 100.0 * peak_to_peak(sizes_N) / mean(std::span<const double>(sizes_N));
      swing.ns[s] = direction.ns[s] = all.ns;
    }
    rows.insert(rows.end(), {swing, direction});
  }
  return rows;
}

namespace {

// As sulcus-lab pareto has it: a burr of 20 voxels' radius, 4 deep, on the crown.
constexpr double kPressedRadius_m = 20.0 * kForceVoxel_m, kPressedDepth_m = 4.0 * kForceVoxel_m;

Burr pressed_burr(int samples) {
  BurrSettings settings;
  settings.diameter_m = 2.0 * kPressedRadius_m;
  settings.field_samples = Eigen::Vector3i(samples, 4 * samples, samples);
  return make_burr(settings, kForceVoxel_m);
}

double rms_off_pct(std::span<const Vector3d> forces_N, std::span<const Vector3d> truth_N) {
  double squares = 0.0;
  for (std::size_t p = 0; p < forces_N.size(); ++p) {
    squares += (forces_N[p] - truth_N[p]).squaredNorm() / truth_N[p].squaredNorm();
  }
  return 100.0 * std::sqrt(squares / static_cast<double>(forces_N.size()));
}

std::vector<Vector3d> continuum_forces(const KnownSurface& surface, const Burr& burr,
                                       std::span<const PressedPose> poses) {
  std::vector<Vector3d> forces_N(poses.size());
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t p) {
    forces_N[p] = continuum_force(surface, burr, poses[p].world_from_tool, poses[p].truth.box_world,
                                  TissueSettings().stiffness_N_per_m, 4);
  });
  return forces_N;
}

}  // namespace

std::vector<FractionRow> fractions_of_net_force(const FractionOptions& options) {
  const HapticsSettings settings;
  const Burr burr = pressed_burr(128), fine = pressed_burr(192);
  const Molar molar;
  const ComposedShape shape({side_of(molar)}, molar.bounds());
  VoxelGrid grid;
  grid.cells = Eigen::Vector3i::Constant(512);
  grid.voxel_m = kForceVoxel_m;

  const auto row_of = [](std::string setting) {
    FractionRow row;
    row.quantity = "net_force_rms_pct";
    row.shape = "molar";
    row.setting = std::move(setting);
    row.wanted = 0.15;
    return row;
  };
  FractionRow whole = row_of("against the continuous surface");
  FractionRow known = row_of("true normals, against the continuous surface");
  FractionRow same_voxels = row_of("against true normals of the same voxels");
  FractionRow directions = row_of("by the normals alone, same voxels");
  std::vector<Pose> poses;
  std::vector<Vector3d> continuous_N;
  for (std::size_t s = 0; s < 2; ++s) {
    options.progress("net force: " + std::string(kSurfaceNames[s]));
    const Workpiece workpiece{voxelise_implicit(molar, grid, nullptr, {}, kBothSurfaces[s])};
    KnownSurface surface(workpiece, shape);
    std::vector<PressedPose> pressed;
    if (s == 0) {
      pressed =
          pressed_poses(surface, fine, kPressedRadius_m, kPressedDepth_m, 1e-3, 200, 1, settings);
      for (const PressedPose& pose : pressed) poses.push_back(pose.world_from_tool);
      options.progress("net force: the continuous surface");
      continuous_N = continuum_forces(surface, fine, pressed);
    } else {  // the same poses on other voxels
      ContactScratch scratch(settings);
      for (const Pose& pose : poses) {
        pressed.push_back({pose, true_force(surface, fine, pose, settings, scratch)});
      }
    }
    const ParetoSetting kLdmAt6[] = {ParetoSetting{}};
    const ParetoRow found =
        measure_pareto(surface, {&burr, 1}, pressed, kLdmAt6, options.progress).front();
    std::vector<Vector3d> known_N;
    known_N.reserve(pressed.size());
    for (const PressedPose& pose : pressed) known_N.push_back(pose.truth.force_N);
    whole.value[s] = rms_off_pct(evaluate_at(workpiece, burr, poses).force_N, continuous_N);
    known.value[s] = rms_off_pct(known_N, continuous_N);
    same_voxels.value[s] = found.whole_pct;
    directions.value[s] = found.directions_pct;
    whole.ns[s] = 1e3 * found.tick_us;
  }
  return {directions, same_voxels, whole, known};
}

}  // namespace sulcus::lab
