#include "app/session/run_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::run_statistics_test {
namespace {

TEST(Distribution, OfNothingAllIsZero) {
  const Distribution none;
  EXPECT_EQ(none.mean(), 0.0);
  EXPECT_EQ(none.quantile(0.5), 0.0);
  EXPECT_EQ(none.largest(), 0.0);
}

TEST(Distribution, QuantilesAreThoseOfSortedValuesToHalfABin) {
  std::mt19937 random(5);
  for (const double spread : {0.1, 1.0, 5.0}) {
    Distribution distribution;
    std::vector<double> values;
    double sum = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const auto value =
          static_cast<float>(std::exp(spread * std::normal_distribution<double>(1.0, 1.0)(random)));
      distribution.add(value);
      values.push_back(value);
      sum += value;
    }
    std::ranges::sort(values);
    EXPECT_EQ(distribution.count(), values.size());
    EXPECT_NEAR(distribution.sum(), sum, 1e-9 * sum);
    EXPECT_EQ(distribution.largest(), values.back());
    EXPECT_EQ(distribution.quantile(1.0), values.back());
    for (const double part : {0.0, 0.1, 0.5, 0.9, 0.99, 0.999}) {
      const double expected = values[static_cast<std::size_t>(std::lround(part * 19999))];
      EXPECT_NEAR(distribution.quantile(part), expected, 0.004 * expected) << part;
    }
  }
}

TEST(Distribution, WhatIsZeroIsZeroAndWhatIsNoNumberIsCounted) {
  Distribution distribution;
  for (int i = 0; i < 10; ++i) distribution.add(i % 2 == 0 ? 0.0f : -0.0f);
  EXPECT_EQ(distribution.quantile(0.5), 0.0);
  distribution.add(-3.0f);
  EXPECT_EQ(distribution.quantile(1.0), 0.0);
  distribution.add(std::numeric_limits<float>::quiet_NaN());
  distribution.add(std::numeric_limits<float>::infinity());
  EXPECT_EQ(distribution.count(), 13u);
  EXPECT_EQ(distribution.quantile(0.5), 0.0);
  EXPECT_GT(distribution.largest(), 1e30);
}

TEST(ChartSeries, NeverHoldsMoreThanAChartCanShow) {
  ChartSeries series;
  for (std::uint64_t tick = 0; tick < 1'000'000; ++tick) {
    series.add({.time_s = static_cast<double>(tick), .tick_us = static_cast<float>(tick % 7)});
    ASSERT_LT(series.points().size(), 40000u);
  }
  const auto& points = series.points();
  ASSERT_GT(points.size(), 10000u);
  const double stride = points[1].time_s;
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(points[i].time_s, static_cast<double>(i) * stride);
    ASSERT_EQ(points[i].tick_us, static_cast<float>(std::fmod(points[i].time_s, 7.0)));
  }
}

TEST(ChartSeries, OfAShortRunEveryTickIsThere) {
  ChartSeries series;
  for (std::uint64_t tick = 0; tick < 1000; ++tick)
    series.add({.time_s = static_cast<double>(tick)});
  EXPECT_EQ(series.points().size(), 1000u);
}

}  // namespace
}  // namespace sulcus::run_statistics_test
