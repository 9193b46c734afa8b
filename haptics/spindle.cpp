#include "haptics/spindle.hpp"

#include <algorithm>

namespace sulcus {

double spindle_speed(const SpindleSettings& settings, double free_rad_per_s, double now_rad_per_s,
                     double load_Nm, double dt_s) noexcept {
  if (free_rad_per_s <= 0.0) return 0.0;
  const double per_torque = dt_s / settings.inertia_kg_m2;
  const double driven = now_rad_per_s + per_torque * (settings.stall_torque_Nm - load_Nm);
  return std::max(0.0, driven / (1.0 + per_torque * settings.stall_torque_Nm / free_rad_per_s));
}

}  // namespace sulcus
