#pragma once

#include <array>
#include <span>
#include <string_view>

#include "engine/scene/scene.hpp"

namespace sulcus {

struct HandpiecePreset {
  std::string_view name;
  SpindleSettings spindle;
  double free_rad_per_s;  // without load
};

/// The names below, in their order, for where a scene chooses one.
inline constexpr std::array<std::string_view, 2> kHandpiecePresetNames{"turbine", "electric"};

/// What dentists cut with. Sources stand with the figures.
std::span<const HandpiecePreset> handpiece_presets() noexcept;

}  // namespace sulcus
