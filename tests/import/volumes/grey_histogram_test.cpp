#include "engine/import/volumes/grey_histogram.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::grey_histogram_test {
namespace {

/// Values about means with one deviation, each as often as asked; whole numbers where asked.
struct Mode {
  double mean;
  int count;
};
std::vector<float> modes(std::initializer_list<Mode> all, double deviation, bool whole = true) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, deviation);
  std::vector<float> values;
  for (const Mode& mode : all) {
    for (int i = 0; i < mode.count; ++i) {
      const double value = mode.mean + noise(random);
      values.push_back(static_cast<float>(whole ? std::round(value) : value));
    }
  }
  return values;
}

TEST(GreyHistogram, CountsEveryValueOnce) {
  for (const bool whole : {true, false}) {
    const std::vector<float> values = modes({{100, 30000}, {900, 10000}}, 20, whole);
    const GreyHistogram histogram = grey_histogram(values);
    EXPECT_EQ(histogram.total(), 40000u);
    EXPECT_NEAR(histogram.quantile(0.375), 100, histogram.width + 1);
    EXPECT_NEAR(histogram.quantile(0.875), 900, histogram.width + 1);
    EXPECT_LE(histogram.counts.size(), 256u);
  }
}

TEST(GreyHistogram, BinsOfWholeNumbersHoldAsManyEach) {
  std::vector<float> values;
  for (int v = 0; v <= 1300; ++v) values.push_back(static_cast<float>(v));
  const GreyHistogram histogram = grey_histogram(values);
  EXPECT_EQ(histogram.width, 6.0);
  for (std::size_t i = 0; i + 1 < histogram.counts.size(); ++i) {
    EXPECT_EQ(histogram.counts[i], 6u) << i;
  }
}

TEST(GreyHistogram, AFillingDoesNotSqueezeTheTeeth) {
  std::vector<float> values = modes({{0, 60000}, {1000, 20000}}, 30);
  for (int i = 0; i < 20; ++i) values.push_back(30000);
  const GreyHistogram histogram = grey_histogram(values);
  EXPECT_LT(histogram.width, 10.0);
  EXPECT_EQ(histogram.total(), values.size());
  EXPECT_NEAR(otsu_thresholds(histogram, 1).at(0), 500, 100);
}

TEST(GreyHistogram, NoValuesAndOneValue) {
  EXPECT_EQ(grey_histogram({}).total(), 0u);
  EXPECT_TRUE(otsu_thresholds(grey_histogram({}), 1).empty());
  const std::vector<float> same(100, 7.0f);
  EXPECT_EQ(grey_histogram(same).total(), 100u);
  EXPECT_TRUE(otsu_thresholds(grey_histogram(same), 1).empty());
  // Two values: one threshold, which parts them, however many are asked for.
  std::vector<float> two(100, 7.0f);
  two.resize(150, 90.0f);
  const std::vector<double> parts = otsu_thresholds(grey_histogram(two), 2);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_GT(parts[0], 7.0);
  EXPECT_LE(parts[0], 90.0);
}

TEST(OtsuThresholds, PartTwoModesInTheMiddle) {
  for (const bool whole : {true, false}) {
    const GreyHistogram histogram = grey_histogram(modes({{200, 40000}, {1000, 40000}}, 60, whole));
    const std::vector<double> two = otsu_thresholds(histogram, 1);
    ASSERT_EQ(two.size(), 1u);
    EXPECT_NEAR(two[0], 600, 40);
    EXPECT_FALSE(has_three_classes(histogram, two, otsu_thresholds(histogram, 2)));
  }
}

TEST(OtsuThresholds, PartThreeModes) {
  const GreyHistogram histogram =
      grey_histogram(modes({{400, 70000}, {840, 20000}, {1190, 7000}}, 40));
  const std::vector<double> three = otsu_thresholds(histogram, 2);
  ASSERT_EQ(three.size(), 2u);
  EXPECT_NEAR(three[0], 620, 100);
  EXPECT_NEAR(three[1], 1015, 100);
  EXPECT_TRUE(has_three_classes(histogram, otsu_thresholds(histogram, 1), three));
  // Mostly air, as in a scan of a whole jaw, but two classes all the same.
  const GreyHistogram air = grey_histogram(modes({{0, 95000}, {1000, 5000}}, 40));
  EXPECT_FALSE(has_three_classes(air, otsu_thresholds(air, 1), otsu_thresholds(air, 2)));
}

TEST(OtsuThresholds, LeaveTheLeastVarianceWithin) {
  const GreyHistogram histogram = grey_histogram(modes({{100, 5000}, {160, 3000}}, 25));
  const double otsu = otsu_thresholds(histogram, 1).at(0);
  const double least = histogram.variance_within(std::vector<double>{otsu});
  for (std::size_t i = 1; i < histogram.counts.size(); ++i) {
    const std::vector<double> other{histogram.edge(i)};
    EXPECT_GE(histogram.variance_within(other), least * (1 - 1e-9)) << other[0];
  }
}

TEST(LabelCounts, TellsValuesAndBoxes) {
  const int sizes[3] = {4, 3, 2};
  std::vector<float> values(24, 0.0f);
  values[1] = 2;                   // (1, 0, 0)
  values[2 + 4 * 2 + 12 * 1] = 2;  // (2, 2, 1)
  values[3] = 5;
  const std::vector<LabelCount> labels = label_counts(values, sizes);
  ASSERT_EQ(labels.size(), 3u);
  EXPECT_EQ(labels[0].voxels, 21u);
  EXPECT_EQ(labels[1].value, 2);
  EXPECT_EQ(labels[1].voxels, 2u);
  EXPECT_EQ(labels[1].low[0], 1);
  EXPECT_EQ(labels[1].high[0], 2);
  EXPECT_EQ(labels[1].low[1], 0);
  EXPECT_EQ(labels[1].high[1], 2);
  EXPECT_EQ(labels[1].high[2], 1);
  EXPECT_EQ(labels[2].value, 5);
}

TEST(LabelCounts, GreyValuesAreNone) {
  const int sizes[3] = {40, 1, 1};
  std::vector<float> values(40, 1.0f);
  values[3] = 1.5f;
  EXPECT_TRUE(label_counts(values, sizes).empty());
  for (int i = 0; i < 40; ++i) values[i] = static_cast<float>(i);
  EXPECT_TRUE(label_counts(values, sizes).empty());
  EXPECT_EQ(label_counts(values, sizes, 40).size(), 40u);
}

}  // namespace
}  // namespace sulcus::grey_histogram_test
