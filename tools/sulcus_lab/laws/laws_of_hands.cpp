#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/import/build_workpiece.hpp"
#include "engine/scene/scene_file.hpp"
#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/laws/laws.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr double kSlide_m = 10e-3;
constexpr double kPressed_m = 1e-3;  // of the device below the surface: 0.7 N

/// A long strip with a plane through the origin.
VoxelModel strip(double voxel_m, SurfaceKind surface, const Vector3d& up) {
  return law_voxels({kSlide_m + 1.4e-3, std::max(0.8e-3, 24 * voxel_m), 2.2e-3}, voxel_m, surface,
                    {[=](const Vector3d& p) { return up.dot(p); }});
}

struct Slide {
  double speed_m_per_s = 0.1, rate_hz = 1000.0;
};

/// The largest force along a plane in the second half of a slide, the tool behind a coupling.
double drag_N(std::string_view scaling, const VoxelModel& solid, const Vector3d& up,
              const Slide& slide) {
  Scene scene = law_scene({.scaling = scaling, .coupling = true});
  scene.haptics.rate_hz = slide.rate_hz;
  const Vector3d forward = (Vector3d::UnitX() - up.x() * up).normalized();
  const Vector3d above = kLawRadius_m * up - 0.5 * kSlide_m * forward;
  const Vector3d pressed = above - kPressed_m * up;
  LawRig rig(scene, solid);
  rig.steps(poses_along(std::vector<Vector3d>{above + 0.05e-3 * up, pressed}, 10e-6));
  rig.steps(std::vector<Pose>(20, pose_at_centre(pressed)));
  const std::vector<Pose> way =
      poses_along(std::vector<Vector3d>{pressed, pressed + kSlide_m * forward},
                  slide.speed_m_per_s / slide.rate_hz);
  double most_N = 0.0;
  for (std::size_t t = 1; t < way.size(); ++t) {
    const double along_N = std::abs(forward.dot(rig.step(way[t]).commanded.force_N));
    if (2 * t >= way.size()) most_N = std::max(most_N, along_N);
  }
  return most_N;
}

void slide_on_planes(LawTrial& trial, const std::string& name, const Vector3d& up) {
  if (!trial.asks_for(name)) return;
  for (const double voxel_um : trial.settings<double>({34.8}, {12.5, 34.8, 100.0})) {
    const VoxelModel solid = strip(1e-6 * voxel_um, trial.surface(), up);
    for (const std::string& scaling : trial.scalings()) {
      for (const double speed : trial.settings<double>({50, 400}, {50, 100, 200, 400, 500})) {
        const std::string setting =
            with_number("voxels of %g um ", voxel_um) + with_number("%g mm/s", speed);
        trial.add({name, scaling, setting}, "drag_N",
                  drag_N(scaling, solid, up, {.speed_m_per_s = 1e-3 * speed}), at_most(0.01));
      }
      if (voxel_um != 34.8) continue;
      const double at_1_kHz_N = drag_N(scaling, solid, up, {});
      for (const double rate_hz : trial.settings<double>({250}, {100, 250, 4000})) {
        const double off_N = drag_N(scaling, solid, up, {.rate_hz = rate_hz}) - at_1_kHz_N;
        trial.add({name, scaling, with_number("%g Hz against 1 kHz at 100 mm/s", rate_hz)},
                  "drag_off_N", std::abs(off_N), rate_hz == 250 ? at_most(0.02) : RowLimit{});
      }
    }
  }
}

/// Forces at each millimetre's hundredth of a way over a shape at a speed, and the poses between.
std::vector<Vector3d> forces_over(std::string_view scaling, const LawShape& shape, double step_m) {
  const Vector3d middle = touching_centre(shape) - kPressed_m * shape.normal;
  const Vector3d half = 0.5e-3 * shape.along();
  LawRig rig(law_scene({.scaling = scaling, .coupling = true}), shape.model);
  rig.steps(poses_along(std::vector<Vector3d>{middle - half + 1.5e-3 * shape.normal, middle - half},
                        10e-6));
  rig.steps(std::vector<Pose>(50, pose_at_centre(middle - half)));
  std::vector<Vector3d> forces_N;
  for (const Pose& pose :
       poses_along(std::vector<Vector3d>{middle - half, middle + half}, step_m)) {
    forces_N.push_back(rig.step(pose).commanded.force_N);
  }
  return forces_N;
}

/// How far the force at 100 mm/s is from that of a slow slide at the same places. Only reported:
/// where a surface curves, a tool that comes later is elsewhere.
void slide_on_molar(LawTrial& trial) {
  if (!trial.asks_for("molar")) return;
  const LawShape shape = law_shape("molar", trial.surface());
  for (const std::string& scaling : trial.scalings()) {
    const std::vector<Vector3d> slow = forces_over(scaling, shape, 5e-6);
    for (const int speed : trial.settings<int>({100}, {50, 100, 200, 500})) {
      const std::vector<Vector3d> fast = forces_over(scaling, shape, 1e-6 * speed);
      const std::size_t each = static_cast<std::size_t>(speed) / 5;
      double most_N = 0.0;
      for (std::size_t t = 0; t < fast.size() && t * each < slow.size(); ++t) {
        most_N = std::max(most_N, (fast[t] - slow[t * each]).norm());
      }
      trial.add({"molar", scaling, with_number("%g mm/s against 5 mm/s", speed)}, "force_off_N",
                most_N);
    }
  }
}

}  // namespace

/// Behind the coupling, no friction, pressed with 0.7 N: along a plane nothing is felt.
void free_slide(LawTrial& trial) {
  slide_on_planes(trial, "flat", Vector3d::UnitZ());
  if (!trial.quick()) slide_on_planes(trial, "plane", Vector3d(0.04, 0.3, 1.0).normalized());
  slide_on_molar(trial);
}

/// scenes/hand_cut.toml: what the passivity controller adds to the coupling's force, from tick to
/// tick. Ticks in which a limit of the output acts are left out.
void quiet_controller(LawTrial& trial) {
  if (!trial.asks_for("hand_cut")) return;
  constexpr std::string_view kOfScene[] = {"smooth", "potential"};
  for (const std::string& scaling : trial.scalings(kOfScene)) {
    const std::vector<std::string> overrides{"haptics.scaling='" + scaling + "'",
                                             "workpiece.surface='" + trial.surface_name() + "'"};
    const Scene scene = load_scene(SULCUS_SCENES "/hand_cut.toml", overrides);
    LawRig rig(scene, build_workpiece(scene));
    const Trajectory hand = make_trajectory(scene.trajectory);
    SimulatedDevice device(*scene.device, hand, scene.haptics.rate_hz, scene.burr.reference_m);
    const int ticks = static_cast<int>(hand.duration_s() * scene.haptics.rate_hz);
    Vector3d before_N = Vector3d::Zero();
    bool has_before = false;
    double most_N = 0.0;
    int pairs = 0, over = 0;
    for (int t = 0; t < ticks; ++t) {
      const TickResult result = rig.step(device);
      if (rig.state().port.passivity.sent.limited) {
        has_before = false;
        continue;
      }
      const Vector3d own_N = result.sent.force_N - result.commanded.force_N;
      if (has_before) {
        const double step_N = (own_N - before_N).norm();
        most_N = std::max(most_N, step_N);
        ++pairs;
        over += step_N >= 0.02 ? 1 : 0;
      }
      before_N = own_N;
      has_before = true;
    }
    const LawPlace where{"hand_cut", scaling, ""};
    trial.add(where, "controllers_own_step_N", most_N, at_most(0.02));
    trial.add(where, "ticks_beyond_percent", 100.0 * over / pairs);
    trial.add(where, "ticks", pairs, at_least(500.0));
  }
}

}  // namespace sulcus::lab
