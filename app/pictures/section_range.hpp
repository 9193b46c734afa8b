#pragma once

#include <span>
#include <string>

#include "engine/graphics/rendered_body.hpp"
#include "engine/scene/section.hpp"

namespace sulcus {

/// Where bodies lie along a world axis (0, 1, 2), m.
struct Extent {
  double low_m = 0.0, high_m = 0.0;
};
/// To the faces of their voxels; of a turned body, to those of a box around it. low > high: none.
Extent extent_along(int axis, std::span<const RenderedBody> bodies);

/// A plane beside all that is drawn would leave all of it, or nothing. @throws InputError with the
/// range that there is; `text` is what was asked for, with --section.
void check_section(const Section& section, std::span<const RenderedBody> bodies,
                   const std::string& text);

}  // namespace sulcus
