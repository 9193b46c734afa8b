#include "engine/graphics/image.hpp"

#include <stdexcept>

#include <png.h>

namespace sulcus {

void write_png(const Image& image, const std::string& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  // Frames are written while the simulation runs: a third of the time for a tenth more bytes.
  png.flags = PNG_IMAGE_FLAG_FAST;
  if (png_image_write_to_file(&png, file.c_str(), 0, image.rgb.data(), 0, nullptr) == 0) {
    const std::string why = png.message;
    png_image_free(&png);
    throw std::runtime_error(file + ": the picture could not be written: " + why);
  }
}

}  // namespace sulcus
