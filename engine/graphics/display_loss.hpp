#pragma once

namespace sulcus {

/// Takes over what Xlib does by itself when the display breaks down or somebody else destroys the
/// window: it would end the process, with all that is not on disk yet. Where the window is not on
/// an X display it does nothing. Main thread, after the window has been made, and again now and
/// then, as GLFW takes it back.
void watch_for_display_loss();

/// Whether either has happened: nothing more is to be asked of GLFW.
bool display_is_lost();

}  // namespace sulcus
