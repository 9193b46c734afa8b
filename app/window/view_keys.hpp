#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "engine/graphics/camera.hpp"

namespace sulcus {

/// What a key of a window asks for.
enum class ViewAction : std::uint8_t {
  kCamera,
  kPause,
  kStepBack,
  kStepOn,
  kExport,
  kCopyPlace,
  kMeasure,
  kArrows,
  kFigures,
  kSection,
  kPlan,
  kColourByPlan,
  kMirror,
  kSpindle,
  kNextBurr,
  kClutch,
  kRecentre,
  kEnd,
};

struct ViewKey {
  char key;               // as WindowInput::keys has it
  std::string_view name;  // as it is written
  std::string_view what;  // it does
  ViewAction action;
  bool in_scene = true, in_recording = true;
};

/// All keys of both windows, none twice.
std::span<const ViewKey> view_keys();
/// None of a key that does nothing there.
std::optional<ViewAction> action_of(char key, bool in_recording);

/// The camera of a key; none where it has none.
std::optional<Viewpoint> camera_of(char key);

}  // namespace sulcus
