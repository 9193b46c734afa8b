#include "haptics/device/output_limiter.hpp"

#include <algorithm>

namespace sulcus {

namespace {

constexpr double kRamp_s = 0.1;
constexpr double kFall_s = 0.05;

/// A vector in its own direction, no longer than `limit`. Scaled first, since the squares of large
/// numbers overflow.
Eigen::Vector3d shortened(const Eigen::Vector3d& v, double limit) {
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest == 0.0) return v;
  const Eigen::Vector3d scaled = v / largest;
  const double length = scaled.norm();
  if (largest * length <= limit) return v;
  return scaled * (limit / length);
}

bool equal(const Wrench& a, const Wrench& b) {
  return a.force_N == b.force_N && a.torque_Nm == b.torque_Nm;
}

/// The ramp of the next tick.
double next_ramp(double ramp, const OutputLimits& limits, const DeviceAnswer& answer) {
  return answer.silent ? std::max(0.0, ramp - limits.dt_s / kFall_s)
                       : std::min(1.0, ramp + limits.dt_s / kRamp_s);
}

}  // namespace

Wrench cut_off(OutputLimiterState& state) noexcept {
  ++state.not_finite_ticks;
  return state.sent = {};
}

Wrench limit_output(const Wrench& wanted, const OutputLimits& limits, const DeviceAnswer& answer,
                    OutputLimiterState& state) noexcept {
  Wrench rendered;  // what of the wanted the device has
  if (limits.force_N > 0.0) rendered.force_N = wanted.force_N;
  if (limits.torque_Nm > 0.0) rendered.torque_Nm = wanted.torque_Nm;
  const Wrench clamped{shortened(rendered.force_N, limits.force_N),
                       shortened(rendered.torque_Nm, limits.torque_Nm)};
  if (!equal(clamped, rendered)) ++state.clamped_ticks;

  if (answer.jumped) state.ramp = 0.0;
  const Wrench ramped{state.ramp * clamped.force_N, state.ramp * clamped.torque_Nm};
  if (!equal(ramped, clamped)) ++state.ramped_ticks;
  state.ramp = next_ramp(state.ramp, limits, answer);

  const Eigen::Vector3d force_step_N = ramped.force_N - state.sent.force_N;
  const Eigen::Vector3d torque_step_Nm = ramped.torque_Nm - state.sent.torque_Nm;
  const Eigen::Vector3d force_taken_N = shortened(force_step_N, limits.force_step_N);
  const Eigen::Vector3d torque_taken_Nm = shortened(torque_step_Nm, limits.torque_step_Nm);
  // A step that is taken whole ends where it was to go, to the last bit.
  const bool force_whole = force_taken_N == force_step_N;
  const bool torque_whole = torque_taken_Nm == torque_step_Nm;
  if (!force_whole || !torque_whole) ++state.step_limited_ticks;
  state.sent.force_N = force_whole ? ramped.force_N : state.sent.force_N + force_taken_N;
  state.sent.torque_Nm = torque_whole ? ramped.torque_Nm : state.sent.torque_Nm + torque_taken_Nm;
  return state.sent;
}

}  // namespace sulcus
