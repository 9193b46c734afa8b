#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sulcus {

/// What is asked of the pictures of a recording, as `sulcus render` takes it.
struct PictureOptions {
  std::string recording, folder, size, section, colour_by = "tissue", video, sheet, data;
  std::vector<std::string> cameras, kinds;
  std::vector<double> at_s;
  double fps = 0.0;                    // above 0: of the whole run
  std::optional<double> from_s, to_s;  // or of this part of it
  double stereo_mm = 0.0;              // above 0: a second camera so far to the right
  double scale_mm = 0.0;               // above 0: to either side of a goal's wall
  bool arrows = false, contacts = false, no_hud = false, no_handpiece = false, no_tool = false,
       ghost = false, sound = false;
};

}  // namespace sulcus
