#include "tools/sulcus_lab/reality/cutting_rig.hpp"

#include <cmath>
#include <sstream>
#include <string>

#include "engine/core/units.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/scene/scene_file.hpp"
#include "tools/sulcus_lab/laws/law_rig.hpp"

namespace sulcus::lab {

namespace {

// Narrower than the burr, shorter than its head, and not cut through in a second.
constexpr double kBarWide_mm = 0.4, kBarLong_mm = 3.0, kBarTall_mm = 8.0;

/// Whole leaves that hold so much and a voxel at each end.
int cells_for(double size_mm, double voxel_mm) {
  return 8 * static_cast<int>(std::ceil((size_mm / voxel_mm + 2.0) / 8.0));
}

Scene scene_of(const CuttingTrial& trial) {
  std::ostringstream text;
  text << "[[tissue]]\nname = '" << trial.tissue
       << "'\nstiffness_N_per_mm = 300\n[workpiece]\nshape = 'box'\nvoxel_mm = " << trial.voxel_mm
       << "\ncells = [" << cells_for(kBarWide_mm, trial.voxel_mm) << ", "
       << cells_for(kBarLong_mm, trial.voxel_mm) << ", " << cells_for(kBarTall_mm, trial.voxel_mm)
       << "]\n[workpiece.box]\nsize_mm = [" << kBarWide_mm << ", " << kBarLong_mm << ", "
       << kBarTall_mm
       << "]\n[burr]\nshape = 'fissure'\nlength_mm = 4.4\ndiameter_mm = " << trial.diameter_mm
       << '\n';
  if (trial.held_rpm) text << "speed_rpm = " << *trial.held_rpm << '\n';
  text << trial.burr << "\n[trajectory]\npoints_mm = [[0, -2.2, "
       << 0.5 * (kBarTall_mm + trial.diameter_mm) + 0.02
       << "]]\naxis = [0, 1, 0]\nhold_s = 1\nload_N = " << trial.load_N
       << "\n[haptics]\nnormals = 'ldm_fast'\n[cutting]\nlaw = '"
       << kCuttingLawNames[static_cast<std::size_t>(trial.law)] << "'\n";
  if (!trial.held_rpm) text << "[spindle]\npreset = 'turbine'\n";
  return parse_scene(text.str(), "reality.toml");
}

/// What is gone of the only tissue, and what of it has been worked for.
double cut_mm3(const LawRig& rig) {
  const RemovalState& removal = *rig.state().workpiece().removal;
  return (removal.removed_J + removal.stored_J()) /
         rig.scene().tissues.front().specific_energy_J_per_m3 / 1e-9;
}

}  // namespace

CuttingMeasure measure_cutting(const CuttingTrial& trial) {
  const Scene scene = scene_of(trial);
  LawRig rig(scene, build_workpiece(scene));
  const Trajectory trajectory = make_trajectory(scene.trajectory);
  ScriptedDevice device(trajectory, scene.haptics.rate_hz);
  const int ticks = static_cast<int>(scene.haptics.rate_hz), settled = ticks / 2;
  for (int t = 0; t < settled; ++t) rig.step(device);
  const double before_mm3 = cut_mm3(rig);
  CuttingMeasure measure;
  double tangential_N = 0.0, normal_N = 0.0;
  for (int t = settled; t < ticks; ++t) {
    const TickResult result = rig.step(device);
    const Wrench& tangential = result.contact.tangential;
    tangential_N += tangential.force_N.norm();
    normal_N += (result.contact.wrench.force_N - tangential.force_N).norm();
    measure.rpm += result.spindle_rad_per_s / kRevolutionPerMinute / (ticks - settled);
  }
  const double seconds = (ticks - settled) / scene.haptics.rate_hz;
  measure.mm3_per_s = (cut_mm3(rig) - before_mm3) / seconds;
  measure.tangential_ratio = tangential_N / normal_N;
  return measure;
}

}  // namespace sulcus::lab
