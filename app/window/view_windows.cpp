#include "app/window/view_windows.hpp"

namespace sulcus {

void set_picture(GlScene& drawing, const CameraHand& camera, const PictureControls& controls,
                 const Window& window, bool moves) {
  drawing.set_detail(moves ? Detail::kCoarse : Detail::kFull);
  drawing.set_viewpoint(camera.from());
  drawing.set_section(controls.section());
  drawing.set_handpiece(false);
  drawing.set_hud({.title = true, .figures = controls.figures, .arrows = controls.arrows});
  drawing.set_size(window.size().x(), window.size().y());
}

}  // namespace sulcus
