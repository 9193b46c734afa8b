#include "tests/support/looks_like.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/specks.hpp"

namespace sulcus::test::looks_like_test {
namespace {

/// A lit ball, its lower part of another tissue, before a plain background.
struct Drawing {
  double aside = 0.0;                              // pixels
  std::array<double, 3> tissue{0.85, 0.66, 0.34};  // linear RGB
  std::array<int, 4> missing{};                    // left, top, width, height
  double terrace = 0.0;                            // width of steps in the shading, pixels
  double stair = 0.0;                              // of the outline, pixels

  Image image() const {
    constexpr int kWidth = 240, kHeight = 136;
    Image picture{kWidth, kHeight, {}};
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        std::array<double, 3> light{};
        for (int i = 0; i < 16; ++i) {  // 4 x 4 samples a pixel
          const auto sample = colour(x + 0.125 + 0.25 * (i % 4), y + 0.125 + 0.25 * (i / 4));
          for (int c = 0; c < 3; ++c) light[c] += sample[c] / 16.0;
        }
        for (const double l : light) picture.rgb.push_back(byte_of(l));
      }
    }
    return picture;
  }

 private:
  static double stepped(double value, double step) {
    return step > 0.0 ? (std::floor(value / step) + 0.5) * step : value;
  }
  std::array<double, 3> colour(double x, double y) const {
    const std::array<double, 3> background{0.4 - 0.001 * y, 0.42 - 0.001 * y, 0.45 - 0.001 * y};
    const bool hole = x >= missing[0] && x < missing[0] + missing[2] && y >= missing[1] &&
                      y < missing[1] + missing[3];
    const double dx = stepped(x, stair) - 120.0 - aside, dy = stepped(y, stair) - 68.0;
    if (hole || std::hypot(dx, dy) > 50.0) return background;
    const double u = stepped(x - 120.0 - aside, terrace) / 50.0;
    const double v = stepped(y - 68.0, terrace) / 50.0;
    const double height = std::sqrt(std::max(0.0, 1.0 - u * u - v * v));
    const double lit = 0.25 + 0.7 * std::max(0.0, 0.4 * -u + 0.5 * -v + 0.77 * height);
    const std::array<double, 3> enamel{0.9, 0.88, 0.82};
    const auto& own = y > 90.0 ? tissue : enamel;
    return {lit * own[0], lit * own[1], lit * own[2]};
  }
};

Image with_specks(Image image, double share, int by) {
  std::mt19937 random(7);
  const std::size_t pixels = image.rgb.size() / 3;
  for (std::size_t n = 0; n < static_cast<std::size_t>(share * static_cast<double>(pixels)); ++n) {
    const std::size_t p = 3 * (random() % pixels);
    for (std::size_t i = p; i < p + 3; ++i) {
      image.rgb[i] = static_cast<std::uint8_t>(std::clamp(image.rgb[i] + by, 0, 255));
    }
  }
  return image;
}

const Image& whole() {
  static const Image kWhole = Drawing{}.image();
  return kWhole;
}

TEST(StructuralSimilarity, OfAPictureAndItselfIsOne) {
  const Similarity same = structural_similarity(whole(), whole());
  EXPECT_NEAR(same.mean, 1.0, 1e-9);
  EXPECT_NEAR(same.worst, 1.0, 1e-9);
}

TEST(StructuralSimilarity, IsThePublishedOneForPlainAndForNoisyPictures) {
  // Flat pictures: the term of the means alone.
  const Image dark{32, 32, std::vector<std::uint8_t>(3 * 32 * 32, 100)};
  const Image light{32, 32, std::vector<std::uint8_t>(3 * 32 * 32, 150)};
  const double c1 = 6.5025;
  const double expected = (2.0 * 100 * 150 + c1) / (100.0 * 100 + 150.0 * 150 + c1);
  EXPECT_NEAR(structural_similarity(dark, light).mean, expected, 1e-9);
  // Noise against noise of its own has nothing in common with it, at any pixel aside.
  const auto noise = [&](std::uint32_t seed) {
    std::mt19937 random(seed);
    Image image = dark;
    for (std::size_t p = 0; p < image.rgb.size(); p += 3) {
      image.rgb[p] = image.rgb[p + 1] = image.rgb[p + 2] = static_cast<std::uint8_t>(random());
    }
    return image;
  };
  EXPECT_LT(structural_similarity(noise(1), noise(2)).mean, 0.3);
}

TEST(ColourDifference, IsThatOfCielab) {
  // Reference values of D65 sRGB: white 100, 0, 0; red 53.24, 80.09, 67.20.
  const auto white = cielab_of(1, 1, 1), red = cielab_of(1, 0, 0);
  EXPECT_NEAR(white[0], 100.0, 0.01);
  EXPECT_NEAR(white[1], 0.0, 0.05);
  EXPECT_NEAR(white[2], 0.0, 0.05);
  EXPECT_NEAR(red[0], 53.24, 0.05);
  EXPECT_NEAR(red[1], 80.09, 0.05);
  EXPECT_NEAR(red[2], 67.20, 0.05);
  EXPECT_EQ(colour_difference(whole(), whole()).worst, 0.0);
}

TEST(LooksLike, ItselfAndWhatAPixelMoves) {
  EXPECT_TRUE(looks_like(whole(), whole()));
  for (const double aside : {0.3, 0.5, 1.0, -1.0}) {
    Drawing moved;
    moved.aside = aside;
    EXPECT_TRUE(looks_like(moved.image(), whole())) << aside;
  }
}

TEST(LooksLike, NotWhereATissueHasAnotherColour) {
  Drawing other;
  other.tissue = {0.85, 0.60, 0.28};
  EXPECT_FALSE(looks_like(other.image(), whole()));
}

TEST(LooksLike, NotWhereABrickIsMissing) {
  Drawing holed;
  for (const auto& missing : {std::array{100, 40, 12, 12}, std::array{158, 60, 12, 12}}) {
    holed.missing = missing;
    EXPECT_FALSE(looks_like(holed.image(), whole())) << missing[0];
    EXPECT_FALSE(looks_like(whole(), holed.image())) << missing[0];
  }
}

TEST(LooksLike, NotWhereShadingOrOutlineIsAStaircase) {
  Drawing terraced;
  terraced.terrace = 6.0;
  EXPECT_FALSE(looks_like(terraced.image(), whole()));
  Drawing stairs;
  stairs.stair = 6.0;
  EXPECT_FALSE(looks_like(stairs.image(), whole()));
}

TEST(LooksLike, NotWithSpecks) {
  EXPECT_FALSE(looks_like(with_specks(whole(), 0.001, 60), whole()));
  EXPECT_FALSE(looks_like(with_specks(whole(), 0.001, -60), whole()));
}

TEST(LooksLike, NotOfAnotherSize) {
  EXPECT_FALSE(looks_like(cropped(whole(), 0, 0, 100, 100), whole()));
}

TEST(Specks, AreCountedAndEdgesAreNot) {
  const std::size_t at_corners = speck_pixels(whole());  // where three tissues meet
  EXPECT_LE(at_corners, 4u);
  const double share = 0.001;
  const auto put = static_cast<std::size_t>(share * 240 * 136);
  const std::size_t found = speck_pixels(with_specks(whole(), share, -60));
  EXPECT_GT(found, put * 9 / 10);
  EXPECT_LE(found, put + at_corners);
  // A line a pixel wide is a line.
  Image lined = whole();
  for (int x = 20; x < 220; ++x) lined.rgb[3 * (240 * 30 + x)] = 0;
  EXPECT_LE(speck_pixels(lined), at_corners);
}

TEST(PicturePlane, ReducedKeepsTheLightAndCroppedThePixels) {
  const Image image{2, 2, {0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 0}};
  const Image one = reduced(image, 2);
  ASSERT_EQ(one.rgb.size(), 3u);
  EXPECT_EQ(one.rgb[0], 188);  // half of the light
  EXPECT_EQ(cropped(image, 1, 0, 1, 2).rgb, (std::vector<std::uint8_t>{255, 255, 255, 0, 0, 0}));
}

}  // namespace
}  // namespace sulcus::test::looks_like_test
