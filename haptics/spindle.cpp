#include "haptics/spindle.hpp"

#include <algorithm>
#include <cmath>

namespace sulcus {

double spindle_speed(const SpindleSettings& settings, double free_rad_per_s, double now_rad_per_s,
                     double load_Nm, double dt_s) noexcept {
  if (free_rad_per_s <= 0.0) return 0.0;
  const double per_torque = dt_s / settings.inertia_kg_m2;
  // w' = w + per_torque (torque(w') - load), solved for each part of the torque. Each falls with
  // the speed, so where the least of them acts the least speed is the solution.
  const double steep_Nm = settings.stall_torque_Nm / settings.droop;
  const double driven = now_rad_per_s + per_torque * (steep_Nm - load_Nm);
  double speed = driven / (1.0 + per_torque * steep_Nm / free_rad_per_s);
  if (settings.droop < 1.0) {
    const double most = now_rad_per_s + per_torque * (settings.stall_torque_Nm - load_Nm);
    speed = std::min(speed, most);
  }
  if (settings.power_W) {
    const double coasting = now_rad_per_s - per_torque * load_Nm;
    const double root = std::sqrt(coasting * coasting + 4.0 * per_torque * *settings.power_W);
    speed = std::min(speed, 0.5 * (coasting + root));
  }
  return std::max(0.0, speed);
}

}  // namespace sulcus
