#pragma once

#include "engine/graphics/camera.hpp"

namespace sulcus {

// A mouth mirror: what it shows is what a camera on the far side sees, left and right exchanged.

/// The camera of a mirror that stands behind what `from` looks at, upright in the direction in
/// which `azimuth_deg` says `from` stands (as Viewpoint's), and looks down on it by so many
/// degrees. Held so that `elevation_deg` is that of `from`, it is a plane mirror across the line of
/// sight's level part, through what is looked at.
Viewpoint mirror_viewpoint(const Viewpoint& from, double azimuth_deg, double elevation_deg);

/// A view whose picture has left and right exchanged; triangles then turn the other way round.
View mirrored(View view);

}  // namespace sulcus
