#include "engine/scene/device_presets.hpp"

#include <stdexcept>
#include <string>

#include "engine/core/units.hpp"

namespace sulcus {

namespace {

/// What DeviceSettings says of itself. Mass, damping, friction and resolution as in the loops that
/// the stability measurements simulate; its data sheet gives 0.26 N of friction.
DeviceSettings omni() { return {}; }

/// The same mechanism as far as is published: mass, damping, friction and resolution are the
/// Omni's.
DeviceSettings touch() {
  DeviceSettings d = omni();
  d.stiffness_N_per_m = 400.0;
  return d;
}

/// As the model that renders torques. Published are the limits of force and stiffness; all else is
/// ours: 75 g, 0.04 N, 30 um, 0.5 N m, 1e-4 kg m2, 0.0023 degrees, a turning damping that is small
/// beside the hand's, and no turning friction.
DeviceSettings premium15() {
  DeviceSettings d;
  d.force_limit_N = 8.5;
  d.torque_limit_Nm = 0.5;
  d.stiffness_N_per_m = 800.0;
  d.mass_kg = 0.075;
  d.damping_N_s_per_m = 0.1;
  d.friction_N = 0.04;
  d.resolution_m = 30e-6;
  d.inertia_kg_m2 = 1e-4;
  d.turning_damping_Nm_s_per_rad = 1e-4;
  d.turning_friction_Nm = 0.0;
  d.angle_resolution = 0.0023 * kDegree;
  return d;
}

/// Published are force and stiffness; mass, friction and resolution are ours.
DeviceSettings falcon() {
  DeviceSettings d;
  d.force_limit_N = 8.0;
  d.stiffness_N_per_m = 3000.0;
  d.mass_kg = 0.1;
  d.damping_N_s_per_m = 0.1;
  d.friction_N = 0.3;
  d.resolution_m = 60e-6;
  return d;
}

/// What HandSettings says of itself.
HandSettings light() { return {}; }

HandSettings hand(double mass_kg, double damping_N_s_per_m, double stiffness_N_per_m) {
  HandSettings h;
  h.mass_kg = mass_kg;
  h.damping_N_s_per_m = damping_N_s_per_m;
  h.stiffness_N_per_m = stiffness_N_per_m;
  return h;
}

template <class Preset>
const auto& settings_of(std::span<const Preset> presets, std::string_view name) {
  for (const Preset& preset : presets) {
    if (preset.name == name) return preset.settings;
  }
  throw std::logic_error("no preset has the name " + std::string(name));
}

}  // namespace

std::span<const DevicePreset> device_presets() noexcept {
  static const std::array<DevicePreset, 4> presets{{{kDevicePresetNames[0], touch()},
                                                    {kDevicePresetNames[1], omni()},
                                                    {kDevicePresetNames[2], premium15()},
                                                    {kDevicePresetNames[3], falcon()}}};
  return presets;
}

const DeviceSettings& device_preset(std::string_view name) {
  return settings_of(device_presets(), name);
}

std::span<const HandPreset> hand_presets() noexcept {
  static const std::array<HandPreset, 3> presets{{{kHandPresetNames[0], light()},
                                                  {kHandPresetNames[1], hand(0.05, 8.0, 300.0)},
                                                  {kHandPresetNames[2], hand(0.554, 6.45, 135.0)}}};
  return presets;
}

const HandSettings& hand_preset(std::string_view name) { return settings_of(hand_presets(), name); }

}  // namespace sulcus
