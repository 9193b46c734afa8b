#pragma once

#include <string>
#include <vector>

namespace sulcus {

/// What is asked of the pictures of a recording, as `sulcus render` takes it.
struct PictureOptions {
  std::string recording, folder, size, section, colour_by = "tissue", video, sheet;
  std::vector<std::string> cameras;
  std::vector<double> at_s;
  double fps = 0.0;  // above 0: of the whole run
  bool arrows = false, contacts = false, no_hud = false, no_handpiece = false, sound = false;
};

}  // namespace sulcus
