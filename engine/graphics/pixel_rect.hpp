#pragma once

#include <algorithm>

#include <Eigen/Geometry>

#include "engine/graphics/camera.hpp"

namespace sulcus {

/// Pixels of a picture from its lower left corner: [x, x + width), [y, y + height).
struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
  /// The smallest that holds both.
  PixelRect with(const PixelRect& other) const {
    if (empty()) return other;
    if (other.empty()) return *this;
    const int left = std::min(x, other.x), low = std::min(y, other.y);
    return {left, low, std::max(x + width, other.x + other.width) - left,
            std::max(y + height, other.y + other.height) - low};
  }
  /// By so many pixels on each side, as far as the picture goes.
  PixelRect grown(int by, int picture_width, int picture_height) const {
    if (empty()) return {};
    const int left = std::clamp(x - by, 0, picture_width),
              low = std::clamp(y - by, 0, picture_height);
    return {left, low, std::clamp(x + width + by, 0, picture_width) - left,
            std::clamp(y + height + by, 0, picture_height) - low};
  }
};

/// The pixels that anything inside a box (world, m) can be on; all of the picture where the box
/// reaches behind the eye.
PixelRect pixels_of(const View& view, const Eigen::AlignedBox3f& box_world, int width, int height);

}  // namespace sulcus
