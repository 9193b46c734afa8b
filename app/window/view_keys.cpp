#include "app/window/view_keys.hpp"

#include <algorithm>
#include <array>

#include "engine/graphics/window_input.hpp"

namespace sulcus {

namespace {

using enum ViewAction;

constexpr std::array kKeys{
    ViewKey{'1', "1", "from above (occlusal)", kCamera},
    ViewKey{'2', "2", "buccal", kCamera},
    ViewKey{'3', "3", "lingual", kCamera},
    ViewKey{'4', "4", "mesial", kCamera},
    ViewKey{'5', "5", "distal", kCamera},
    ViewKey{'6', "6", "the burr, close", kCamera},
    ViewKey{'0', "0", "the whole tooth, oblique", kCamera},
    ViewKey{' ', "space", "pauses; plays", kPause},
    ViewKey{'<', "left", "a step back", kStepBack, false},
    ViewKey{'>', "right", "a step on", kStepOn, false},
    ViewKey{'e', "e", "exports the tooth", kExport, false},
    ViewKey{'c', "c", "copies the place under the pointer", kCopyPlace},
    ViewKey{'d', "d", "sets a point of the caliper", kMeasure},
    ViewKey{'a', "a", "arrows of force and torque", kArrows},
    ViewKey{'h', "h", "figures", kFigures},
    ViewKey{'x', "x", "section", kSection},
    ViewKey{'g', "g", "the planned cavity", kPlan},
    ViewKey{'o', "o", "colours by the plan", kColourByPlan},
    ViewKey{'m', "m", "mouth mirror", kMirror},
    ViewKey{'p', "p", "the spindle's switch", kSpindle, true, false},
    ViewKey{'b', "b", "the next spare burr", kNextBurr, true, false},
    ViewKey{'k', "k", "clutch of a device", kClutch, true, false},
    ViewKey{'r', "r", "brings a device to the start", kRecentre, true, false},
    ViewKey{'q', "q", "ends", kEnd},
    ViewKey{WindowInput::kEscape, "Esc", "ends", kEnd},
};

}  // namespace

std::span<const ViewKey> view_keys() { return kKeys; }

std::optional<ViewAction> action_of(char key, bool in_recording) {
  const auto* const found = std::ranges::find(kKeys, key, &ViewKey::key);
  if (found == kKeys.end()) return {};
  if (!(in_recording ? found->in_recording : found->in_scene)) return {};
  return found->action;
}

std::optional<Viewpoint> camera_of(char key) {
  switch (key) {
    case '0':
      return Camera::kReview;
    case '1':
      return Camera::kOcclusal;
    case '2':
      return Camera::kBuccal;
    case '3':
      return Viewpoint(90.0, 0.0);  // opposite to buccal
    case '4':
      return Camera::kMesial;
    case '5':
      return Viewpoint(180.0, 0.0);
    case '6':
      return Camera::kBurr;
    default:
      return {};
  }
}

}  // namespace sulcus
