#pragma once

#include <stdexcept>
#include <string>

#include <png.h>

#include "engine/graphics/image.hpp"

namespace sulcus::test {

/// Reads a PNG file. Throws std::runtime_error, naming it, where it cannot be read.
inline Image read_png(const std::string& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  Image image;
  if (png_image_begin_read_from_file(&png, file.c_str()) != 0) {
    png.format = PNG_FORMAT_RGB;
    image = {static_cast<int>(png.width), static_cast<int>(png.height), {}};
    image.rgb.resize(PNG_IMAGE_SIZE(png));
    if (png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr) != 0) return image;
  }
  std::string why = file;
  why += ": ";
  why += png.message;
  png_image_free(&png);
  throw std::runtime_error(why);
}

/// Writes one as small as it gets: a picture that is kept.
inline void write_small_png(const Image& image, const std::string& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(&png, file.c_str(), 0, image.rgb.data(), 0, nullptr) != 0) return;
  std::string why = file;
  why += ": ";
  why += png.message;
  throw std::runtime_error(why);
}

}  // namespace sulcus::test
