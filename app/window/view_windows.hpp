#pragma once

#include <string>
#include <vector>

#include "app/window/camera_hand.hpp"
#include "engine/graphics/gl_scene.hpp"
#include "engine/graphics/panels.hpp"
#include "engine/graphics/window.hpp"

namespace sulcus {

struct ViewOptions {
  std::string file, folder;            // a scene or a recording; for the results
  bool force = false;                  // replaces another run in `folder`
  std::vector<std::string> overrides;  // of a scene, as of --set
  int width = 1280, height = 720;
  bool mouse = false;                       // holds the burr, whatever device the scene names
  std::vector<std::string> plugin_folders;  // in which its plug-in is looked for
};

/// Plays a recording in a window until that is closed.
void view_recording(const ViewOptions& options);
/// Runs a scene under the hand on its device, or under the mouse, until that says that it is over
/// or the window is closed.
void view_scene(const ViewOptions& options);

// What both windows have.

/// Sets what the picture is of: the camera, the controls, the window's size. `moves`: the camera
/// does, so that less has to be drawn. Without the handpiece, which would be in the way.
void set_picture(GlScene& drawing, const CameraHand& camera, const PictureControls& controls,
                 const Window& window, bool moves);

}  // namespace sulcus
