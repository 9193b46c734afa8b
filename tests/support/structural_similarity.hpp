#pragma once

#include <algorithm>

#include "tests/support/picture_plane.hpp"

namespace sulcus::test {

/// How alike two pictures of one size are in structure: 1 where they are the same.
struct Similarity {
  double mean = 1.0;
  double worst = 1.0;  // mean of the square of 16 x 16 pixels that is least alike
};

/// Structural similarity of luma [Wang, Bovik, Sheikh, Simoncelli 2004, eq. 13]: Gaussian window of
/// 1.5 pixels, K1 = 0.01, K2 = 0.03, L = 255.
///
/// Departure: at each pixel the second picture may be up to a pixel aside, and the best of these
/// nine counts. Where an edge falls on the pixels is the driver's; the measure as published drops
/// as far for that as for something missing. And the mean alone does not see what is small, so the
/// worst square is told as well. Windows lie inside: 6 pixels at the border are not looked at.
inline Similarity structural_similarity(const Image& image_a, const Image& image_b) {
  constexpr double kSigma = 1.5;
  constexpr double kC1 = 0.01 * 255 * 0.01 * 255, kC2 = 0.03 * 255 * 0.03 * 255;
  const int width = image_a.width, height = image_a.height;
  const auto product = [](const Plane& a, const Plane& b, int dx, int dy) {
    return make_plane(a.width, a.height,
                      [&](int x, int y) { return a.at(x, y) * b.near(x + dx, y + dy); });
  };
  const Plane a = luma(image_a), b = luma(image_b);
  const Plane mean_a = blurred(a, kSigma), mean_b = blurred(b, kSigma);
  const Plane square_a = blurred(product(a, a, 0, 0), kSigma);
  const Plane square_b = blurred(product(b, b, 0, 0), kSigma);
  constexpr int kBorder = 6, kSquare = 16;
  const auto most_alike = [&] {
    Plane best(width, height);
    std::fill(best.values.begin(), best.values.end(), -1.0);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Plane both = blurred(product(a, b, dx, dy), kSigma);
        for (int y = kBorder; y < height - kBorder; ++y) {
          for (int x = kBorder; x < width - kBorder; ++x) {
            const double ma = mean_a.at(x, y), mb = mean_b.at(x + dx, y + dy);
            const double va = square_a.at(x, y) - ma * ma;
            const double vb = square_b.at(x + dx, y + dy) - mb * mb;
            const double ssim = (2 * ma * mb + kC1) * (2 * (both.at(x, y) - ma * mb) + kC2) /
                                ((ma * ma + mb * mb + kC1) * (va + vb + kC2));
            best.at(x, y) = std::max(best.at(x, y), ssim);
          }
        }
      }
    }
    return best;
  };
  const Plane best = most_alike();
  const auto mean_over = [&](int left, int top, int right, int bottom) {
    double sum = 0.0;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) sum += best.at(x, y);
    }
    return sum / ((right - left) * (bottom - top));
  };
  const int right = width - kBorder, bottom = height - kBorder;
  Similarity result{mean_over(kBorder, kBorder, right, bottom), 1.0};
  for (int top = kBorder; top + kSquare / 2 < bottom; top += kSquare / 2) {
    for (int left = kBorder; left + kSquare / 2 < right; left += kSquare / 2) {
      result.worst = std::min(result.worst, mean_over(left, top, std::min(left + kSquare, right),
                                                      std::min(top + kSquare, bottom)));
    }
  }
  return result;
}

}  // namespace sulcus::test
