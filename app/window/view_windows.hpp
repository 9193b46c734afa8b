#pragma once

#include <string>
#include <vector>

namespace sulcus {

struct ViewOptions {
  std::string file, folder;            // a scene or a recording; for the results
  bool force = false;                  // replaces another run in `folder`
  std::vector<std::string> overrides;  // of a scene, as of --set
  int width = 1280, height = 720;
};

/// Plays a recording in a window until that is closed.
void view_recording(const ViewOptions& options);
/// Runs a scene under the mouse until the window is closed.
void view_scene(const ViewOptions& options);

}  // namespace sulcus
