#pragma once

#include <array>
#include <span>
#include <string_view>

#include "engine/scene/scene.hpp"

namespace sulcus {

struct DevicePreset {
  std::string_view name;
  DeviceSettings settings;  // its hand is HandSettings' own default
};
struct HandPreset {
  std::string_view name;
  HandSettings settings;  // pushes nothing
};

/// The names below, in their order, for where a scene chooses one.
inline constexpr std::array<std::string_view, 4> kDevicePresetNames{"touch", "omni", "premium15",
                                                                    "falcon"};
inline constexpr std::array<std::string_view, 3> kHandPresetNames{"light", "firm", "arm"};

/// Devices that are widely had. Force and stiffness are the limits published with CHAI3D. The
/// damping published there (4, 5, 5, 20 N s/m) is the largest to render, not the mechanism's own:
/// that is 0.1 N s/m for all of them.
std::span<const DevicePreset> device_presets() noexcept;
/// That of one name. std::logic_error where there is none, here and below.
const DeviceSettings& device_preset(std::string_view name);

/// How a handle is held: lightly, without a mass of the hand's, firmly, or with the arm behind it.
/// How they hold its direction (HandSettings::turning_*) is the same for all, and ours.
std::span<const HandPreset> hand_presets() noexcept;
const HandSettings& hand_preset(std::string_view name);

}  // namespace sulcus
