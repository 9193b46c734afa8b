#pragma once

#include <cstdint>
#include <span>
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

/// The same bytes. Throws std::runtime_error where they cannot be made.
std::vector<std::uint8_t> png_bytes(const Image& image);

/// Numbers as a PNG file: 8 bits each, grey; or 16 bits each, of one channel or three. Rows from
/// the top. std::runtime_error as above; std::invalid_argument where they are not so many.
std::vector<std::uint8_t> png_bytes(std::span<const std::uint8_t> grey, int width, int height);
std::vector<std::uint8_t> png_bytes(std::span<const std::uint16_t> numbers, int width, int height,
                                    int channels);

/// Pictures of one size side by side, so many in a row; what is left of the last row is white.
/// None: an empty picture. Throws std::invalid_argument for pictures of several sizes.
Image sheet_of(std::span<const Image> images, int columns);

}  // namespace sulcus
