#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/graphics/image.hpp"

// Pictures as planes of numbers, for measures of how two of them differ.
namespace sulcus::test {

/// A number for each pixel, rows from the top.
struct Plane {
  int width = 0, height = 0;
  std::vector<double> values;

  Plane() = default;
  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * h) {}
  double& at(int x, int y) { return values[static_cast<std::size_t>(y) * width + x]; }
  double at(int x, int y) const { return values[static_cast<std::size_t>(y) * width + x]; }
  /// Beyond the border the nearest pixel.
  double near(int x, int y) const {
    return at(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1));
  }
};

/// A plane of what `value(x, y)` says.
template <class Value>
Plane make_plane(int width, int height, const Value& value) {
  Plane plane(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) plane.at(x, y) = value(x, y);
  }
  return plane;
}

/// Its first byte of red, green and blue.
inline const std::uint8_t* pixel(const Image& image, int x, int y) {
  return &image.rgb[3 * (static_cast<std::size_t>(y) * image.width + x)];
}

/// Luma, 0 to 255 (ITU-R BT.709).
inline Plane luma(const Image& image) {
  return make_plane(image.width, image.height, [&](int x, int y) {
    const std::uint8_t* p = pixel(image, x, y);
    return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
  });
}

/// Light, 0 to 1, of an sRGB byte, and back (IEC 61966-2-1).
inline double light_of(std::uint8_t byte) {
  static const auto kTable = [] {
    std::array<double, 256> table{};
    for (int b = 0; b < 256; ++b) {
      const double s = b / 255.0;
      table[b] = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    }
    return table;
  }();
  return kTable[byte];
}
inline std::uint8_t byte_of(double light) {
  const double s = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(s, 0.0, 1.0)));
}

/// Convolved with a Gaussian of `sigma` pixels, cut off at 3 sigma and more.
inline Plane blurred(const Plane& plane, double sigma) {
  const int reach = static_cast<int>(std::ceil(3.3 * sigma));
  std::vector<double> weights;
  double sum = 0.0;
  for (int d = -reach; d <= reach; ++d) {
    weights.push_back(std::exp(-0.5 * d * d / (sigma * sigma)));
    sum += weights.back();
  }
  for (double& w : weights) w /= sum;
  const auto along = [&](const Plane& from, int dx, int dy) {
    return make_plane(from.width, from.height, [&](int x, int y) {
      double value = 0.0;
      for (int d = -reach; d <= reach; ++d) {
        value += weights[d + reach] * from.near(x + d * dx, y + d * dy);
      }
      return value;
    });
  };
  return along(along(plane, 1, 0), 0, 1);
}

/// The same picture from further away: each pixel the mean light of `factor` x `factor`. What is
/// left over at the right and below is left out.
inline Image reduced(const Image& image, int factor) {
  Image small{image.width / factor, image.height / factor, {}};
  small.rgb.reserve(3 * static_cast<std::size_t>(small.width) * small.height);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      for (int channel = 0; channel < 3; ++channel) {
        double light = 0.0;
        for (int i = 0; i < factor * factor; ++i) {
          light +=
              light_of(pixel(image, x * factor + i % factor, y * factor + i / factor)[channel]);
        }
        small.rgb.push_back(byte_of(light / (factor * factor)));
      }
    }
  }
  return small;
}

/// A part of a picture, pixel by pixel.
inline Image cropped(const Image& image, int left, int top, int width, int height) {
  Image part{width, height, {}};
  for (int y = top; y < top + height; ++y) {
    const std::uint8_t* row = pixel(image, left, y);
    part.rgb.insert(part.rgb.end(), row, row + 3 * static_cast<std::size_t>(width));
  }
  return part;
}

}  // namespace sulcus::test
