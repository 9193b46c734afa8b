#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sulcus {

/// A picture, 8-bit sRGB.
struct Image {
  int width = 0, height = 0;      // pixels
  std::vector<std::uint8_t> rgb;  // 3 bytes a pixel, rows from the top

  bool operator==(const Image&) const = default;
};

/// Writes a PNG file; the same image gives the same bytes. Throws std::runtime_error, naming the
/// file, where it cannot be written. Any thread.
void write_png(const Image& image, const std::string& file);

}  // namespace sulcus
