#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "app/session/simulation.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/load_burr.hpp"
#include "tools/sulcus_lab/stability/cases/case_solids.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

/// Where over a voxel the tool comes down.
std::vector<Vector3d> places_mm(bool brief) {
  if (brief) return {kCaseVoxel_mm * Vector3d(0.23, 0.41, 0.0)};
  return {Vector3d::Zero(), kCaseVoxel_mm * Vector3d(0.5, 0.5, 0.0),
          kCaseVoxel_mm * Vector3d(0.23, 0.41, 0.0)};
}

std::string wall_of(int voxels) {
  return "wall of " + std::to_string(voxels) + (voxels == 1 ? " voxel" : " voxels");
}

Vector3d up(double mm) { return Vector3d(0.0, 0.0, mm); }

}  // namespace

/// The device goes so far beyond the face that the coupling is at its limit, the tool's own depth
/// included, slowly: 4 um in a tick. What the other methods hold is measured on the same way, 25 um
/// in a tick where the force depends on nothing but the pose.
void thin_wall(CaseTrial& trial) {
  constexpr double kSlow_mm_per_s = 4.0, kFast_mm_per_s = 25.0, kToolDepth_mm = 0.2;
  constexpr double kFall_N = 0.01, kRounding_N = 1e-6;
  const double beyond_mm = kCaseForceLimit_N / kCaseSpring_N_per_mm + kToolDepth_mm;
  const std::vector<int> walls = trial.settings<int>({1, 2}, {1, 2, 3, 6, 12});
  const Scene scene = method_scene(trial.method, case_text());
  const double speed_mm_per_s = is_held_outside(trial.method) ? kSlow_mm_per_s : kFast_mm_per_s;
  for (const int voxels : walls) {
    const VoxelModel wall = wall_solid(voxels);
    double fall_N = 0.0, reached_N = HUGE_VAL;
    std::vector<Felt> ticks;
    for (const Vector3d& place : places_mm(trial.brief)) {
      ticks = run_path(trial.method, scene, wall,
                       case_path({place + up(0.05), place - up(beyond_mm)}, speed_mm_per_s));
      fall_N = std::max(fall_N, largest_fall_N(ticks));
      reached_N = std::min(reached_N, ticks.back().force_N.z());
    }
    trial.add("force_reversal_N", wall_of(voxels), fall_N, at_most(kFall_N));
    trial.add("force_reached_N", wall_of(voxels), reached_N,
              at_least(kCaseForceLimit_N - kRounding_N));
    if (voxels == 2) {
      trial.trace(wall_of(voxels), ticks);
    }
  }
}

/// A share of what the thickest wall gives at the same place. Behind the coupling the tool does not
/// come so deep; there the device is that deep, and beside it the coupling's contact is measured
/// with the tool put there, which is the harder test.
void thin_wall_stiffness(CaseTrial& trial) {
  constexpr double kDepth_mm = 0.1, kShare = 0.9;
  constexpr int kThick = 12;
  const std::vector<int> walls = trial.settings<int>({1, 2}, {1, 2, 3, 6});
  const Scene scene = method_scene(trial.method, case_text());
  Scene placed = scene;
  placed.coupling.reset();
  const auto force_N = [&](const Scene& s, int voxels, const Vector3d& place) {
    const std::vector<Pose> path = case_path({place + up(0.05), place - up(kDepth_mm)}, 5.0, 100);
    return run_path(trial.method, s, wall_solid(voxels), path).back().force_N.z();
  };
  const auto measure = [&](const Scene& s, const char* quantity) {
    for (const int voxels : walls) {
      double share = HUGE_VAL;
      for (const Vector3d& place : places_mm(trial.brief)) {
        share = std::min(share, force_N(s, voxels, place) / force_N(s, kThick, place));
      }
      trial.add(quantity, wall_of(voxels), share, at_least(kShare));
    }
  };
  measure(scene, "felt_share");
  if (scene.coupling) measure(placed, "contact_share");
}

/// Straight through a plate and 2 mm on, and a rest there, in which a tool that lags can still come
/// through. Starts differ by sixteenths of a voxel across the way and, along it, of a voxel or of a
/// tick's step, whichever is longer. Crossed is where the tip is beyond the far face.
void tunnelling(CaseTrial& trial) {
  constexpr int kPhases = 16, kRest = 100;
  const int voxels = static_cast<int>(std::round(0.3 / kCaseVoxel_mm));
  const double far_m = -voxels * kCaseVoxel_m;
  const std::vector<double> speeds_mm_per_s =
      trial.settings<double>({100, 1000}, {10, 30, 100, 300, 1000});
  const VoxelModel plate = wall_solid(voxels);
  const Scene scene = method_scene(trial.method, case_text());
  for (const double speed : speeds_mm_per_s) {
    const std::string setting = std::to_string(static_cast<int>(speed)) + " mm/s";
    int crossed = 0;
    for (int phase = 0; phase < kPhases; phase += trial.brief ? 4 : 1) {
      const double part = static_cast<double>(phase) / kPhases;
      const Vector3d place = part * kCaseVoxel_mm * Vector3d(1.0, 0.6, 0.0);
      const double above_mm = 0.1 + part * std::max(kCaseVoxel_mm, speed * kMillisecond);
      const std::vector<Pose> path =
          case_path({place + up(above_mm), place - up(2.3)}, speed, kRest);
      Rig rig(trial.method, scene, plate);
      PathDevice device(path);
      std::vector<Felt> ticks;
      bool through = false;
      while (ticks.size() < path.size() && !through) {
        ticks.push_back(rig.step(device));
        through = ticks.back().tool.position.z() < far_m;
      }
      crossed += through;
      if (phase == 0 && (speed == 100.0 || speed == 1000.0)) {
        trial.trace(setting, ticks);
      }
    }
    trial.add("crossings", setting, crossed, at_most(0.0));
  }
}

/// Out of a face, a thin wall and an acute groove. The pull is the force's part towards the solid.
/// Parted is when the device's tip is above the face, in a groove when nothing touches any more.
void sticking(CaseTrial& trial) {
  constexpr double kDepth_mm = 0.3, kSpeed_mm_per_s = 5.0, kPull_N = 0.02;
  constexpr double kZero_N = 1e-3;  // what a micrometre of a device's spring gives
  struct Solid {
    std::string name;
    VoxelModel model;
    bool is_wall;
  };
  std::vector<Solid> solids{{wall_of(12), wall_solid(12), true}, {wall_of(2), wall_solid(2), true}};
  if (!trial.brief) solids.push_back({"V of 30 degrees", groove_solid(30 * kDegree, 0.0), false});
  const Scene scene = method_scene(trial.method, case_text());
  for (const Solid& solid : solids) {
    std::vector<Pose> path = case_path({up(0.1), -up(kDepth_mm)}, kSpeed_mm_per_s, 50);
    const std::size_t retracts = path.size();
    go_on(path, up(0.3), kSpeed_mm_per_s, 20);
    const std::vector<Felt> ticks = run_path(trial.method, scene, solid.model, path);
    double pull_N = 0.0;
    int late = 0;
    for (std::size_t t = retracts; t < ticks.size(); ++t) {
      const Felt& felt = ticks[t];
      pull_N = std::max(pull_N, -felt.force_N.z());
      const bool parted = felt.contacts == 0 || (solid.is_wall && felt.device.position.z() > 0.0);
      late += parted && felt.force_N.norm() >= kZero_N;
    }
    trial.add("pull_N", solid.name, pull_N, at_most(kPull_N));
    trial.add("force_after_parting_ticks", solid.name, late, at_most(1.0));
    if (&solid != &solids[1]) {
      trial.trace(solid.name, ticks);
    }
  }
}

/// Down into a block, a rest there, and back; and a rest from the start where the tool's middle is
/// still outside. It leads out where it gives the handle more than its own friction. Starts with
/// the middle inside are refused before the first tick, whatever the method.
void deep_inside(CaseTrial& trial) {
  constexpr double kSpeed_mm_per_s = 20.0, kFall_N = 0.01, kFriction_N = 0.05;
  const VoxelModel block = wall_solid(48);
  const std::vector<double> depths = trial.settings<double>({1.0, 3.0}, {0.5, 1.0, 1.5, 2.0, 3.0});
  const Scene scene = method_scene(trial.method, case_text());
  /// `in`: ticks of the way in.
  const auto judge = [&](const std::string& setting, const std::vector<Pose>& path, std::size_t in,
                         std::size_t out) {
    const std::vector<Felt> ticks = run_path(trial.method, scene, block, path);
    double largest_N = 0.0;
    int not_finite = 0;
    for (const Felt& felt : ticks) {
      largest_N = std::max(largest_N, felt.force_N.norm());
      not_finite += !felt.force_N.allFinite() || felt.faults != 0;
    }
    trial.add("not_finite_ticks", setting, not_finite, at_most(0.0));
    trial.add("force_reversal_N", setting, largest_fall_N(std::span(ticks).first(in)),
              at_most(kFall_N));
    trial.add("largest_force_N", setting, largest_N, at_most(kCaseForceLimit_N));
    trial.add("outward_force_N", setting, ticks[out].force_N.z(), at_least(kFriction_N));
    return ticks;
  };
  for (const double depth : depths) {
    const std::string setting = with_number("%g R deep", depth);
    std::vector<Pose> path =
        case_path({up(0.1), -up(depth * kCaseRadius_mm)}, kSpeed_mm_per_s, 100);
    const std::size_t in = path.size();
    go_on(path, up(0.1), kSpeed_mm_per_s, 20);
    const std::vector<Felt> ticks = judge(setting, path, in, in - 1);
    if (depth == 3.0) {
      trial.trace(setting, ticks);
    }
  }
  if (trial.method == ContactMethod::kSinglePoint) return;  // refused as a burr, or not at all
  judge("started 0.5 R deep", case_path({-up(0.5 * kCaseRadius_mm)}, 1.0, 200), 1, 200);
  int refused = 0, starts = 0;
  const Burr burr = load_burr(scene);
  for (const double depth : {1.1, 1.5, 2.0, 3.0}) {
    ++starts;
    try {
      check_start(scene, block, {}, burr, case_path({-up(depth * kCaseRadius_mm)}, 1.0).front());
    } catch (const InputError&) {
      ++refused;
    }
  }
  trial.add("share_of_starts_refused", "1.1 to 3 R deep", static_cast<double>(refused) / starts,
            at_least(1.0));
}

}  // namespace sulcus::lab
