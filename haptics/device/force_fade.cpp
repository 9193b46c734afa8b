#include "haptics/device/force_fade.hpp"

#include <algorithm>
#include <cmath>

namespace sulcus {

namespace {

constexpr double kFade_s = 0.05;
constexpr int kMostSteps = 1'000'000;  // a force beyond all limits ends as well

}  // namespace

ForceFade::ForceFade(const Wrench& held, const OutputLimits& limits) noexcept {
  const double force_N = held.force_N.norm(), torque_Nm = held.torque_Nm.norm();
  if (!std::isfinite(force_N) || !std::isfinite(torque_Nm)) return;
  if (force_N == 0.0 && torque_Nm == 0.0) return;
  const double steps = std::max({kFade_s / limits.dt_s, force_N / limits.force_step_N,
                                 torque_Nm / limits.torque_step_Nm, 1.0});
  left_ = static_cast<int>(std::min<double>(std::ceil(steps - 1e-6), kMostSteps));
  step_ = {held.force_N / left_, held.torque_Nm / left_};
}

Wrench ForceFade::next() noexcept {
  if (left_ > 0) --left_;
  return {left_ * step_.force_N, left_ * step_.torque_Nm};
}

}  // namespace sulcus
