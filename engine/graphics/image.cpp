#include "engine/graphics/image.hpp"

#include <algorithm>
#include <stdexcept>

#include <png.h>

#include "engine/core/whole_file.hpp"

namespace sulcus {

namespace {

png_image header_of(int width, int height, png_uint_32 format) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = format;
  // Frames are written while the simulation runs: a third of the time for a tenth more bytes.
  png.flags = PNG_IMAGE_FLAG_FAST;
  return png;
}

std::vector<std::uint8_t> encoded(png_image png, const void* pixels) {
  std::vector<std::uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, pixels, 0, nullptr) == 0) {
    const std::string why = png.message;
    png_image_free(&png);
    throw std::runtime_error("a picture could not be made: " + why);
  }
  bytes.resize(size);
  return bytes;
}

void check_count(std::size_t count, int width, int height, int channels) {
  if (count != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                   static_cast<std::size_t>(channels)) {
    throw std::invalid_argument("a picture of another size than its numbers");
  }
}

}  // namespace

void write_png(const Image& image, const std::string& file) {
  const std::vector<std::uint8_t> bytes = png_bytes(image);
  write_whole_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::vector<std::uint8_t> png_bytes(const Image& image) {
  return encoded(header_of(image.width, image.height, PNG_FORMAT_RGB), image.rgb.data());
}

std::vector<std::uint8_t> png_bytes(std::span<const std::uint8_t> grey, int width, int height) {
  check_count(grey.size(), width, height, 1);
  return encoded(header_of(width, height, PNG_FORMAT_GRAY), grey.data());
}

std::vector<std::uint8_t> png_bytes(std::span<const std::uint16_t> numbers, int width, int height,
                                    int channels) {
  check_count(numbers.size(), width, height, channels);
  // What libpng calls linear is written as it is.
  const png_uint_32 format = channels == 1 ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_LINEAR_RGB;
  return encoded(header_of(width, height, format), numbers.data());
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
