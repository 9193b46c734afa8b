#include "engine/graphics/mirror.hpp"

namespace sulcus {

Viewpoint mirror_viewpoint(const Viewpoint& from, double azimuth_deg, double elevation_deg) {
  Viewpoint there(azimuth_deg + 180.0, elevation_deg);
  there.follows_burr = from.follows_burr;
  there.zoom = from.zoom;
  there.look_at = from.look_at;
  return there;
}

View mirrored(View view) {
  view.clip_from_world.row(0) = -view.clip_from_world.row(0);
  return view;
}

}  // namespace sulcus
