#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/picture_plane.hpp"

namespace sulcus::test {

/// Pixels that belong to specks: they differ from the median of the 3 x 3 pixels about them by more
/// than `more_than` of 255 in a channel, and so do at most three others that they hang together
/// with. Lines and edges are not specks: a line is long, and an edge is its own median.
inline std::size_t speck_pixels(const Image& image, int more_than = 16) {
  const int width = image.width, height = image.height;
  std::vector<std::uint8_t> differs(static_cast<std::size_t>(width) * height);
  for (int y = 1; y + 1 < height; ++y) {
    for (int x = 1; x + 1 < width; ++x) {
      for (int channel = 0; channel < 3; ++channel) {
        // So far from the median means: five of the nine are so far on the same side.
        const int centre = pixel(image, x, y)[channel];
        int below = 0, above = 0;
        for (int i = 0; i < 9; ++i) {
          const int other = pixel(image, x + i % 3 - 1, y + i / 3 - 1)[channel];
          below += other < centre - more_than;
          above += other > centre + more_than;
        }
        if (below >= 5 || above >= 5) differs[static_cast<std::size_t>(y) * width + x] = 1;
      }
    }
  }
  std::size_t count = 0;
  std::vector<std::size_t> group;
  for (std::size_t start = 0; start < differs.size(); ++start) {
    if (!differs[start]) continue;
    group.assign(1, start);
    differs[start] = 0;
    for (std::size_t next = 0; next < group.size(); ++next) {  // the border never differs
      for (int i = 0; i < 9; ++i) {
        const std::size_t at = group[next] + (i / 3 - 1) * width + i % 3 - 1;
        if (differs[at]) {
          differs[at] = 0;
          group.push_back(at);
        }
      }
    }
    if (group.size() <= 4) count += group.size();
  }
  return count;
}

}  // namespace sulcus::test
