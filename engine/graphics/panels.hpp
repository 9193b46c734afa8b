#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/section.hpp"

namespace sulcus {

// What a window's panels say and ask for. They are drawn between Window::begin and Window::end.

/// How the picture is to be; both kinds of window have it.
struct PictureControls {
  bool figures = true, arrows = false, cut_open = false;
  int axis = 1;  // of the section
  float at_mm = 0.0f;
  bool legend = true;     // of the tissues
  bool has_plan = false;  // a [goal], which is shown, or coloured by
  bool plan = false, by_plan = false;
  bool mirror = false;       // a mouth mirror behind the tooth
  float mirror_deg = 20.0f;  // how far it looks down on it

  std::optional<Section> section() const;
};

/// Of a recording.
struct PlayerControls {
  /// A moment that is marked on the timeline, and can be gone to.
  struct Mark {
    float time_s = 0.0f;
    std::string what;
  };
  std::vector<Mark> marks;
  PictureControls picture;
  float first_s = 0.0f, time_s = 0.0f, end_s = 0.0f;
  float speed = 1.0f;  // seconds a second, below 0: backward
  bool playing = false;
  bool export_asked = false;
  std::string said;  // what came of it
};
void draw_panels(PlayerControls& controls);

/// Of a run under the mouse, or under a hand on a device.
struct LiveControls {
  PictureControls picture;
  bool paused = false;
  bool by_mouse = true;        // which holds the burr
  std::string timing, faults;  // of the ticks
  bool spindle_on = true;
  float pedal = 1.0f;                           // of the burr's speed, 0 to 1
  bool clutch = false, recentre_asked = false;  // of a device that is placed in the scene
  std::vector<std::string> burrs;               // that may be changed to; the scene's first
  std::size_t burr = 0;                         // of them
  float first_s = 0.0f, time_s = 0.0f;          // of this part, its first tick and so far
  float back_s = 1.0f;                          // to take back
  bool looks_back = false;                      // the picture is of then, until it is resumed
  // From where it goes on: the spindle's speed, and the burr, where another is to be taken.
  float speed_rpm = 0.0f;
  bool other_burr = false;
  std::span<const std::string_view> burr_shapes;  // to choose from, each ended by a zero
  std::size_t burr_shape = 0;                     // of them
  float burr_mm = 0.0f, least_burr_mm = 0.0f, most_burr_mm = 0.0f;
  bool go_on_asked = false;  // from `back_s` ago, so
  bool save_asked = false;   // what was done, as a scene
  std::string said;
};
void draw_panels(LiveControls& controls);

}  // namespace sulcus
