#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/scene/section.hpp"
#include "engine/surface/drawn_surface.hpp"

namespace sulcus {

/// What a section shows of a body: a picture in the plane, a pixel to a voxel, of its tissues, or
/// of a quantity that it is coloured by inside too.
struct SectionFace {
  Eigen::Vector3d corner_world, along_world, across_world;  // m: of the picture, and its edges
  int width = 0, height = 0;                                // pixels; 0: the plane passes it by
  // Linear RGB times how much is solid, and that, times 255. Rows along `along`.
  std::vector<std::array<std::uint8_t, 4>> pixels;
};

/// The face of a body whose grid stands at `world_from_grid`, as the body is now. Any thread, while
/// nothing is removed.
SectionFace section_face(const DrawnSurface& body, const Pose& world_from_grid,
                         const Section& section);

}  // namespace sulcus
