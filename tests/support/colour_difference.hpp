#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tests/support/picture_plane.hpp"

namespace sulcus::test {

/// How far apart the colours of two pictures of one size are, in units of CIELAB: from about 2.3 on
/// people see a difference.
struct ColourDifference {
  double mean = 0.0, worst = 0.0;
};

/// CIE 1976 L*, a*, b* of light (0 to 1) of the sRGB primaries, white D65.
inline std::array<double, 3> cielab_of(double r, double g, double b) {
  const auto f = [](double t) {
    constexpr double kSmall = 6.0 / 29.0;
    return t > kSmall * kSmall * kSmall ? std::cbrt(t) : t / (3.0 * kSmall * kSmall) + 4.0 / 29.0;
  };
  const double x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
  const double y = f(0.2126 * r + 0.7152 * g + 0.0722 * b);
  const double z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

/// Colour differences as seen from afar, after S-CIELAB [Zhang, Wandell 1997]: light is blurred as
/// the eye does, then compared in CIELAB. Departures: one Gaussian of 2 pixels for all channels
/// instead of three filters by viewing distance, and at each pixel the nearest colour up to a pixel
/// aside counts, as for structural_similarity.
inline ColourDifference colour_difference(const Image& image_a, const Image& image_b) {
  const auto blurred_lab = [](const Image& image) {
    std::array<Plane, 3> planes;
    for (int c = 0; c < 3; ++c) {
      planes[c] = blurred(make_plane(image.width, image.height,
                                     [&](int x, int y) { return light_of(pixel(image, x, y)[c]); }),
                          2.0);
    }
    for (std::size_t p = 0; p < planes[0].values.size(); ++p) {
      const auto lab = cielab_of(planes[0].values[p], planes[1].values[p], planes[2].values[p]);
      for (int c = 0; c < 3; ++c) planes[c].values[p] = lab[c];
    }
    return planes;
  };
  const auto a = blurred_lab(image_a), b = blurred_lab(image_b);
  ColourDifference result;
  for (int y = 0; y < image_a.height; ++y) {
    for (int x = 0; x < image_a.width; ++x) {
      double least = std::numeric_limits<double>::max();
      for (int i = 0; i < 9; ++i) {
        double square = 0.0;
        for (int c = 0; c < 3; ++c) {
          const double d = a[c].at(x, y) - b[c].near(x + i % 3 - 1, y + i / 3 - 1);
          square += d * d;
        }
        least = std::min(least, square);
      }
      const double difference = std::sqrt(least);
      result.mean += difference;
      result.worst = std::max(result.worst, difference);
    }
  }
  result.mean /= static_cast<double>(image_a.width) * image_a.height;
  return result;
}

}  // namespace sulcus::test
