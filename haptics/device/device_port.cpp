#include "haptics/device/device_port.hpp"

#include <algorithm>
#include <optional>

#include "engine/core/fault.hpp"

namespace sulcus {

namespace {

constexpr double kBridged_s = 0.02;

bool is_silent(const DevicePortState& state, double dt_s) {
  constexpr double kRounding = 1e-6;
  return state.silent_ticks > 0 && (!state.has_pose || static_cast<double>(state.silent_ticks) >
                                                           kBridged_s / dt_s + kRounding);
}

bool is_finite(const Pose& pose) {
  return pose.position.allFinite() && pose.orientation.coeffs().allFinite();
}

/// A device's pose with its position that of the point which torques are about.
Pose at_reference(const Pose& pose, double reference_m) {
  return {pose.point({0.0, reference_m, 0.0}), pose.orientation};
}

PassivitySettings passivity_settings(const TickContext& context) {
  PassivitySettings settings;
  settings.dt_s = 1.0 / context.scene.haptics.rate_hz;
  if (context.scene.coupling) {
    settings.stiffness_N_per_m = context.scene.coupling->stiffness_N_per_m;
  }
  if (const auto& device = context.scene.device) {
    settings.limit_N = device->force_limit_N;
    settings.renders_torque = device->torque_limit_Nm > 0.0;
    settings.delayed = device->delay_ticks > 0;
  } else {
    settings.renders_torque = true;
  }
  return settings;
}

}  // namespace

double felt_stiffness(const Scene& scene) noexcept {
  if (scene.coupling) return scene.coupling->stiffness_N_per_m;
  double stiffest = 0.0;
  for (const TissueSettings& t : scene.tissues) stiffest = std::max(stiffest, t.stiffness_N_per_m);
  return stiffest;
}

DeviceReading read_pose(const TickContext& context, Device& device, std::uint64_t tick,
                        DevicePortState& state) noexcept {
  const double dt_s = 1.0 / context.scene.haptics.rate_hz;
  DeviceReading reading;
  const std::optional<Pose> pose = device.pose(tick);
  if (pose && !is_finite(*pose)) {
    reading.faults |= kFaultNotFinite;
    reading.pose = reading.before = state.pose;
    return reading;
  }
  const bool was_silent = is_silent(state, dt_s);
  state.silent_ticks = pose ? 0 : state.silent_ticks + 1;
  reading.silent = is_silent(state, dt_s);
  reading.pose = pose.value_or(state.pose);
  reading.before = state.has_pose ? state.pose : reading.pose;
  reading.jumped = step_of(context.burr, reading.before, reading.pose) > kLongestStep_m;
  reading.slides = !reading.silent && !was_silent && !reading.jumped;
  if (!pose) reading.faults |= reading.silent ? kFaultDeviceSilent : kFaultPoseBridged;
  if (reading.jumped) reading.faults |= kFaultDeviceJumped;
  state.has_pose |= pose.has_value();
  state.pose = reading.pose;
  return reading;
}

double step_of(const Burr& burr, const Pose& from, const Pose& to) noexcept {
  const Eigen::Vector3d end(0.0, burr.head_length_m, 0.0);
  return std::max((to.position - from.position).norm(), (to.point(end) - from.point(end)).norm());
}

Wrench render_wrench(const TickContext& context, const DeviceReading& reading,
                     const Wrench& commanded, DevicePortState& state,
                     std::uint32_t& faults) noexcept {
  const Scene& scene = context.scene;
  const double dt_s = 1.0 / scene.haptics.rate_hz;
  const bool finite = commanded.force_N.allFinite() && commanded.torque_Nm.allFinite();
  if (!finite) faults |= kFaultNotFinite;
  const Wrench wanted = finite ? commanded : Wrench{};
  const PassivitySettings settings = passivity_settings(context);
  observe_passivity(at_reference(reading.pose, context.burr.reference_m), state.passivity);
  const bool broken = (faults & kFaultNotFinite) != 0;
  Wrench sent = broken ? Wrench{} : wanted;
  if (scene.device && broken) {
    sent = cut_off(state.limiter);
  } else if (scene.device) {
    if (scene.device->passivity_controller) {
      sent = control_passivity(sent, settings, state.passivity);
    }
    OutputLimits limits;
    limits.force_N = scene.device->force_limit_N;
    limits.torque_Nm = scene.device->torque_limit_Nm;
    limits.dt_s = dt_s;
    sent = limit_output(sent, limits, {.silent = reading.silent, .jumped = reading.jumped},
                        state.limiter);
  }
  hold_wrench(sent, settings, state.passivity);
  if (scene.device || scene.coupling) {
    const double resolution_m = scene.device ? scene.device->resolution_m : 0.0;
    const double threshold_N = buzz_threshold_N(felt_stiffness(scene), resolution_m);
    if (buzz(wanted.force_N, threshold_N, dt_s, state.buzz)) faults |= kFaultBuzz;
  }
  return sent;
}

}  // namespace sulcus
