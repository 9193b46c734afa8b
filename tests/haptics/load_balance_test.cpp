#include "haptics/load_balance.hpp"

#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::load_balance_test {
namespace {

constexpr double kHalfVoxel = 17.4e-6;

/// A contact of one dimension, and where it was asked about.
struct Wall {
  std::function<Resistance(double)> contact;
  std::vector<double> asked;

  double balance(double from_m, double load_N, double way_m = 1.0) {
    asked.clear();
    return balance_load({load_N, kHalfVoxel, way_m}, from_m, [&](double offset_m, Outputs) {
      asked.push_back(offset_m);
      return contact(offset_m);
    });
  }
};

Resistance spring(double offset_m, double stiffness) {
  return offset_m > 0.0 ? Resistance{stiffness * offset_m, stiffness} : Resistance{};
}

TEST(LoadBalance, OnASpringItStopsWhereTheForceIsTheLoad) {
  Wall wall{[](double x) { return spring(x, 30e3); }, {}};
  EXPECT_NEAR(wall.balance(0.0, 0.3), 0.3 / 30e3, 0.01 * 0.3 / 30e3);
  const double at_m = wall.balance(0.0, 0.3);
  EXPECT_EQ(wall.asked.back(), at_m) << "the last asked is where it is";
}

TEST(LoadBalance, InBalanceItAsksOnce) {
  Wall wall{[](double x) { return spring(x, 30e3); }, {}};
  wall.balance(1.0 / 30e3, 1.0);
  EXPECT_EQ(wall.asked.size(), 1u);
}

TEST(LoadBalance, AForceThatGrowsWithTheSquareOfTheDepthIsFoundToo) {
  // The stiffness said is half of what it is, as of a contact whose weights grow with depth.
  Wall wall{[](double x) { return x > 0.0 ? Resistance{5e8 * x * x, 5e8 * x} : Resistance{}; }, {}};
  for (const double load_N : {0.01, 0.1, 1.0}) {
    double x = 0.0;
    for (int tick = 0; tick < 10; ++tick) x = wall.balance(x, load_N);
    EXPECT_NEAR(5e8 * x * x, load_N, 0.01 * load_N);
    EXPECT_LE(wall.asked.size(), 2u);
  }
}

TEST(LoadBalance, NoStepIsLongerThanHalfAVoxel) {
  Wall wall{[](double x) { return spring(x - 0.1e-3, 30e3); }, {}};
  wall.balance(0.0, 1.0);
  ASSERT_GT(wall.asked.size(), 3u);
  for (std::size_t i = 1; i < wall.asked.size(); ++i) {
    EXPECT_LE(std::abs(wall.asked[i] - wall.asked[i - 1]), kHalfVoxel * (1 + 1e-9));
  }
}

TEST(LoadBalance, InAirItGoesItsWayAndNoFurther) {
  Wall wall{[](double) { return Resistance{}; }, {}};
  EXPECT_DOUBLE_EQ(wall.balance(3e-3, 1.0, 20e-6), 3.02e-3);
}

TEST(LoadBalance, WhereTheContactHoldsMoreItGivesWay) {
  Wall wall{[](double x) { return spring(x, 30e3); }, {}};
  EXPECT_NEAR(wall.balance(80e-6, 1.0, 1e-6), 1.0 / 30e3, 0.01 / 30e3);
}

TEST(LoadBalance, AForceThatJumpsPastTheLoadIsClosedIn) {
  // Nothing, then at once more than the load: no place holds it, and it stays at the jump.
  Wall wall{[](double x) { return x > 10e-6 ? Resistance{2.0, 30e3} : Resistance{}; }, {}};
  EXPECT_NEAR(wall.balance(0.0, 1.0), 10e-6, 0.1e-6);
}

}  // namespace
}  // namespace sulcus::load_balance_test
