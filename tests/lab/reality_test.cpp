#include "tools/sulcus_lab/reality/reality.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/sulcus_lab/reality/cutting_rig.hpp"
#include "tools/sulcus_lab/reality/reality_bands.hpp"

namespace sulcus::lab::reality_test {
namespace {

double sum_of_squares(const SaturatingConstants& constants) {
  double sum = 0.0;
  for (const FittedBand& band : fitted_bands()) {
    sum += std::pow(off_the_middle(band, band.value(constants)), 2);
  }
  return sum;
}

/// Each of the constants.
constexpr double SaturatingConstants::*kEach[] = {
    &SaturatingConstants::grain_area_m2, &SaturatingConstants::diamond_m_per_s,
    &SaturatingConstants::carbide_m_per_s, &SaturatingConstants::wear_length_m};

TEST(RealityFit, TheConstantsInUseAreThoseOfTheFit) {
  const SaturatingConstants in_use, fitted = fit_saturating_law();
  for (const auto constant : kEach) EXPECT_NEAR(in_use.*constant / fitted.*constant, 1.0, 0.01);
  EXPECT_LT(sum_of_squares(in_use), 1.001 * sum_of_squares(fitted));
}

TEST(RealityFit, NoOtherConstantsAreNearerToTheBands) {
  const SaturatingConstants fitted = fit_saturating_law();
  for (const auto constant : kEach) {
    for (const double times : {0.5, 0.95, 1.05, 2.0}) {
      SaturatingConstants other = fitted;
      other.*constant *= times;
      EXPECT_GT(sum_of_squares(other), sum_of_squares(fitted)) << times;
    }
  }
}

TEST(RealityFit, OffTheMiddleIsInHalvesOfTheBand) {
  const FittedBand band{"", "", 0.6, 1.4, nullptr};
  EXPECT_NEAR(off_the_middle(band, 1.0), 0.0, 1e-12);
  EXPECT_NEAR(off_the_middle(band, 1.4), 1.0, 1e-12);
  EXPECT_NEAR(off_the_middle(band, 0.2), -2.0, 1e-12);
}

/// What runs give, for what the fit has in closed form.
TEST(Reality, TheRatesThatTheFitReckonsWithAreThoseOfTheTicks) {
  const std::vector<RealityRow> rows = reality_rates(RealityOptions{});
  for (const FittedBand& band : fitted_bands()) {
    const auto row = std::ranges::find(rows, std::string(band.check), &RealityRow::check);
    ASSERT_NE(row, rows.end()) << band.check;
    EXPECT_TRUE(row->fitted());
    const double measured = row->value[static_cast<std::size_t>(CuttingLaw::kSaturating)];
    EXPECT_NEAR(measured / band.value({}), 1.0, 0.05) << band.check;
  }
}

TEST(Reality, EveryRowHasABandASourceAndTwoFigures) {
  RealityOptions quick;
  quick.quick = true;
  std::set<std::string> checks;
  int in = 0, apart = 0;
  for (const RealitySection& section : reality_sections()) {
    for (const RealityRow& row : section.measure(quick)) {
      SCOPED_TRACE(row.check);
      EXPECT_TRUE(checks.insert(row.check).second);
      EXPECT_FALSE(row.source.empty());
      EXPECT_LT(row.low, row.high);
      for (const double value : row.value) EXPECT_TRUE(std::isfinite(value));
      in += row.in(CuttingLaw::kSaturating) ? 1 : 0;
      apart += row.fitted() ? 0 : 1;
    }
  }
  EXPECT_GE(apart, 6);
  EXPECT_GE(10 * in, 9 * static_cast<int>(checks.size()));
}

TEST(Reality, WhatHasNoFigureIsOut) {
  const RealityRow row{"a", "b", 1.0, 2.0, {1.5, std::nan("")}};
  EXPECT_TRUE(row.in(CuttingLaw::kPaper));
  EXPECT_FALSE(row.in(CuttingLaw::kSaturating));
}

}  // namespace
}  // namespace sulcus::lab::reality_test
