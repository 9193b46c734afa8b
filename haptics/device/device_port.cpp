#include "haptics/device/device_port.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "engine/core/hash.hpp"
#include "engine/recording/tick_record.hpp"

namespace sulcus {

namespace {

/// Nobody moves a handle faster; what does is an encoder that slipped.
constexpr double kFastestHandle_m_per_s = 5.0;

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

std::uint64_t DevicePortState::hash() const {
  std::array<double, 8> values{};
  std::copy_n(pose.position.data(), 3, values.begin());
  std::copy_n(pose.orientation.coeffs().data(), 4, values.begin() + 3);
  values[7] = has_pose ? 1.0 : 0.0;
  const std::array<std::uint64_t, 3> parts{edge.hash(), passivity.hash(), buzz.hash()};
  return hash_bytes(parts.data(), sizeof(parts), hash_bytes(values.data(), sizeof(values)));
}

double felt_stiffness(const Scene& scene) noexcept {
  if (scene.coupling) return scene.coupling->stiffness_N_per_m;
  double stiffest = 0.0;
  for (const TissueSettings& t : scene.tissues) stiffest = std::max(stiffest, t.stiffness_N_per_m);
  return stiffest;
}

DeviceReading read_pose(const TickContext& context, Device& device, std::uint64_t tick,
                        DevicePortState& state) noexcept {
  DeviceReading reading;
  const std::optional<Pose> pose = device.pose(tick);
  reading.answered = pose.has_value();
  reading.pose = pose.value_or(state.pose);
  if (!reading.answered) reading.faults |= kFaultDeviceSilent;
  if (!is_finite(reading.pose)) {
    reading.faults |= kFaultNotFinite;
    reading.pose = reading.before = state.pose;
    return reading;
  }
  reading.before = state.has_pose ? state.pose : reading.pose;
  const double way_m = (reading.pose.position - reading.before.position).norm();
  const double fastest_m = kFastestHandle_m_per_s / context.scene.haptics.rate_hz;
  reading.jumped = context.scene.device && way_m > fastest_m;
  if (reading.jumped) reading.faults |= kFaultDeviceJumped;
  state.has_pose |= reading.answered;
  state.pose = reading.pose;
  return reading;
}

Wrench render_wrench(const TickContext& context, const DeviceReading& reading, const Wrench& asked,
                     DevicePortState& state, std::uint32_t& faults) noexcept {
  const Scene& scene = context.scene;
  const double dt_s = 1.0 / scene.haptics.rate_hz;
  const bool finite = asked.force_N.allFinite() && asked.torque_Nm.allFinite();
  if (!finite) faults |= kFaultNotFinite;
  const PassivitySettings settings = passivity_settings(context);
  observe_passivity(at_reference(reading.pose, context.burr.reference_m), state.passivity);
  Wrench sent = finite ? asked : Wrench{};
  if (scene.device) {
    if (scene.device->passivity_controller) {
      sent = control_passivity(sent, settings, state.passivity);
    }
    DeviceEdgeLimits limits;
    limits.force_N = scene.device->force_limit_N;
    limits.torque_Nm = scene.device->torque_limit_Nm;
    limits.dt_s = dt_s;
    sent = device_edge(sent, limits, reading.answered, reading.jumped, state.edge);
  }
  hold_wrench(sent, settings, state.passivity);
  if (scene.device || scene.coupling) {
    const double resolution_m = scene.device ? scene.device->resolution_m : 0.0;
    const double threshold_N = buzz_threshold_N(felt_stiffness(scene), resolution_m);
    if (buzz(asked.force_N, threshold_N, dt_s, state.buzz)) faults |= kFaultBuzz;
  }
  return sent;
}

}  // namespace sulcus
