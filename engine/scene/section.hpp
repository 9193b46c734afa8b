#pragma once

#include <optional>
#include <string_view>

namespace sulcus {

/// A plane across an axis of the world; what lies on the camera's side of it is left out.
struct Section {
  int axis = 0;  // 0, 1, 2: x, y, z
  double at_m = 0.0;
};

/// What parse_section takes, for messages.
inline constexpr const char* kSectionForm = "an axis and mm, such as y=0 or x=-1.5";

/// "x=1.5", "y = 0" or "z=-2", in mm; none where it is no such thing.
std::optional<Section> parse_section(std::string_view text);

}  // namespace sulcus
