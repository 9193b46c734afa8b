#include <algorithm>
#include <vector>

#include "engine/core/units.hpp"
#include "engine/scene/handpiece_presets.hpp"
#include "haptics/spindle.hpp"
#include "tools/sulcus_lab/reality/cutting_rig.hpp"
#include "tools/sulcus_lab/reality/reality.hpp"

namespace sulcus::lab {

namespace {

/// Where a handpiece settles under a load, rad/s.
double settled_speed(const HandpiecePreset& handpiece, double load_Nm) {
  double speed = handpiece.free_rad_per_s;
  for (int tick = 0; tick < 2000; ++tick) {
    speed = spindle_speed(handpiece.spindle, handpiece.free_rad_per_s, speed, load_Nm, 1e-3);
  }
  return speed;
}

struct Performance {
  double stall_Nm = 0.0;
  double power_W = 0.0;         // the greatest
  double speed_of_power = 0.0;  // over the free one
};

/// As on a brake whose load is raised step by step until it stands.
Performance braked(const HandpiecePreset& handpiece) {
  Performance performance;
  constexpr double kStep_Nm = 5e-6;
  for (double load_Nm = kStep_Nm;; load_Nm += kStep_Nm) {
    const double speed = settled_speed(handpiece, load_Nm);
    if (speed <= 0.0) return performance;
    performance.stall_Nm = load_Nm;
    if (load_Nm * speed < performance.power_W) continue;
    performance.power_W = load_Nm * speed;
    performance.speed_of_power = speed / handpiece.free_rad_per_s;
  }
}

/// In a cut at 1 N with a burr of 1 mm, %.
double sag_percent(CuttingLaw law, bool quick) {
  CuttingTrial trial;
  trial.law = law;
  if (quick) trial.voxel_mm = kQuickVoxel_mm;
  const double free_rpm = handpiece_presets().front().free_rad_per_s / kRevolutionPerMinute;
  return 100.0 * (1.0 - measure_cutting(trial).rpm / free_rpm);
}

}  // namespace

std::vector<RealityRow> reality_handpieces(const RealityOptions& options) {
  options.progress("turbine");
  const Performance turbine = braked(handpiece_presets().front());
  const std::string brockhurst = "Brockhurst and Shams 1994";
  return {
      {"turbine: sag in a light cut, %",
       "322.2 to 288.4 krpm in a cut 50 um deep",
       7.0,
       14.0,
       {sag_percent(CuttingLaw::kPaper, options.quick),
        sag_percent(CuttingLaw::kSaturating, options.quick)}},
      {"turbine: speed of the greatest power over the free speed",
       brockhurst,
       0.49,
       0.79,
       {turbine.speed_of_power, turbine.speed_of_power}},
      {"turbine: stall torque, mN m",
       brockhurst,
       1.0,
       2.33,
       {1e3 * turbine.stall_Nm, 1e3 * turbine.stall_Nm}},
      {"turbine: greatest power, W", brockhurst, 10.0, 29.6, {turbine.power_W, turbine.power_W}}};
}

}  // namespace sulcus::lab
