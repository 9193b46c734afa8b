#include "engine/graphics/image.hpp"

#include <algorithm>
#include <stdexcept>

#include <png.h>

#include "engine/core/whole_file.hpp"

namespace sulcus {

namespace {

png_image header_of(const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  // Frames are written while the simulation runs: a third of the time for a tenth more bytes.
  png.flags = PNG_IMAGE_FLAG_FAST;
  return png;
}

}  // namespace

void write_png(const Image& image, const std::string& file) {
  const std::vector<std::uint8_t> bytes = png_bytes(image);
  write_whole_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::vector<std::uint8_t> png_bytes(const Image& image) {
  png_image png = header_of(image);
  std::vector<std::uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0) {
    const std::string why = png.message;
    png_image_free(&png);
    throw std::runtime_error("a picture could not be made: " + why);
  }
  bytes.resize(size);
  return bytes;
}

Image sheet_of(std::span<const Image> images, int columns) {
  if (images.empty()) return {};
  const int width = images.front().width, height = images.front().height;
  const int rows = (static_cast<int>(images.size()) + columns - 1) / columns;
  Image sheet{width * columns, height * rows, {}};
  const std::size_t line = 3 * static_cast<std::size_t>(width);
  sheet.rgb.assign(
      line * static_cast<std::size_t>(columns) * static_cast<std::size_t>(sheet.height), 255);
  for (std::size_t n = 0; n < images.size(); ++n) {
    const Image& image = images[n];
    if (image.width != width || image.height != height) {
      throw std::invalid_argument("a sheet of pictures of several sizes");
    }
    const std::size_t column = n % static_cast<std::size_t>(columns);
    const std::size_t top =
        n / static_cast<std::size_t>(columns) * static_cast<std::size_t>(height);
    for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
      std::copy_n(&image.rgb[y * line], line,
                  &sheet.rgb[((top + y) * static_cast<std::size_t>(columns) + column) * line]);
    }
  }
  return sheet;
}

}  // namespace sulcus
