#include "engine/surface/colour_scale.hpp"

#include <gtest/gtest.h>

namespace sulcus::colour_scale_test {
namespace {

float grey(const Eigen::Vector3f& colour) {
  return colour.dot(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f));
}

TEST(ColourScale, ARisingOneDarkensWithEveryStep) {
  const ColourScale scale{.name = "s", .low = 2.0, .high = 4.0};
  for (int step = 0; step < 20; ++step) {
    EXPECT_GT(grey(scale.colour(2.0 + 0.1 * step)), grey(scale.colour(2.1 + 0.1 * step))) << step;
  }
  EXPECT_EQ(scale.colour(1.0), scale.colour(2.0));
  EXPECT_EQ(scale.colour(9.0), scale.colour(4.0));
}

TEST(ColourScale, AroundZeroItIsWhiteAndDarkensToBothSidesInTwoHues) {
  const ColourScale scale{
      .name = "m", .low = -1.0, .high = 1.0, .kind = ColourScale::Kind::kAroundZero};
  EXPECT_GT(scale.colour(0.0).minCoeff(), 0.85f);
  for (int step = 0; step < 10; ++step) {
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_GT(grey(scale.colour(sign * 0.1 * step)), grey(scale.colour(sign * 0.1 * (step + 1))));
    }
  }
  const Eigen::Vector3f low = scale.colour(-0.6), high = scale.colour(0.6);
  EXPECT_GT(low.z(), 2.0f * low.x());
  EXPECT_GT(high.x(), 2.0f * high.z());
}

TEST(ColourScale, DecadesAreEvenlyApartAndMarked) {
  const ColourScale scale{.name = "ticks",
                          .low = 1.0,
                          .high = 1000.0,
                          .beyond_high = "and more",
                          .kind = ColourScale::Kind::kDecades};
  EXPECT_DOUBLE_EQ(scale.part(10.0), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(scale.part(0.0), 0.0);
  const auto marks = scale.marks();
  ASSERT_EQ(marks.size(), 4u);
  EXPECT_EQ(marks[1].words, "10");
  EXPECT_EQ(marks[3].words, "1000 and more");
}

TEST(ColourScale, AnEndMayHaveWordsInPlaceOfItsNumber) {
  const ColourScale scale{.name = "m", .low = -1.0, .end_low = "not cut > 1", .end_high = "over"};
  EXPECT_EQ(scale.marks().front().words, "not cut > 1");
  EXPECT_EQ(scale.marks().back().words, "over");
}

TEST(ColourScale, ItsNumbersAreInItsUnit) {
  const ColourScale scale{.name = "mm", .low = -5e-4, .high = 5e-4, .unit = 1e-3};
  const auto marks = scale.marks();
  ASSERT_EQ(marks.size(), 3u);
  EXPECT_EQ(marks[0].words, "-0.5");
  EXPECT_EQ(marks[1].words, "0");
  EXPECT_EQ(marks[2].words, "0.5");
}

}  // namespace
}  // namespace sulcus::colour_scale_test
