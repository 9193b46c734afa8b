#include "engine/core/units.hpp"

#include <gtest/gtest.h>

namespace sulcus::units_test {
namespace {

TEST(Units, AValueTimesItsUnitIsSi) {
  EXPECT_DOUBLE_EQ(34.8e-3 * kMillimetre, 34.8e-6);
  EXPECT_DOUBLE_EQ(20 * kMillisecond, 0.02);
  EXPECT_DOUBLE_EQ(30 * kNewtonPerMillimetre, 30000);
  EXPECT_DOUBLE_EQ(3.5 * kJoulePerMm3, 3.5e9);
  EXPECT_DOUBLE_EQ(180 * kDegree, 3.141592653589793);
  EXPECT_DOUBLE_EQ(60 * kRevolutionPerMinute, 6.283185307179586);
  EXPECT_DOUBLE_EQ(3 * kMebibyte, 3145728);
}

}  // namespace
}  // namespace sulcus::units_test
