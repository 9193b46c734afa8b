#include "engine/core/lane_sums.hpp"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace sulcus {
namespace {

TEST(LaneSums, OfNothingIsZero) { EXPECT_EQ(LaneSums<3>().total(), (std::array<double, 3>{})); }

TEST(LaneSums, AddsEveryTermOnce) {
  for (int terms = 1; terms < 70; ++terms) {
    LaneSums<2> sums;
    for (int t = 0; t < terms; ++t) {
      sums.next();
      sums.add(0, t);
      sums.add(1, 1);
    }
    EXPECT_EQ(sums.total()[0], terms * (terms - 1) / 2);
    EXPECT_EQ(sums.total()[1], terms);
  }
}

TEST(LaneSums, AddsInTheOrderOfKernelsOfEveryWidth) {
  std::mt19937 random(7);
  std::array<double, 1000> terms;
  for (double& term : terms) {
    const double digits = static_cast<double>(random()) - 2e9;
    term = std::ldexp(digits, static_cast<int>(random() % 60));
  }
  LaneSums<1> sums;
  for (double term : terms) {
    sums.next();
    sums.add(0, term);
  }
  // 16 accumulators, then halves upon halves: what a kernel of any width that divides 16 does.
  std::array<double, 16> lanes{};
  for (std::size_t i = 0; i < terms.size(); ++i) lanes[i % 16] += terms[i];
  for (std::size_t i = 0; i < 8; ++i) lanes[i] += lanes[i + 8];
  for (std::size_t i = 0; i < 4; ++i) lanes[i] += lanes[i + 4];
  for (std::size_t i = 0; i < 2; ++i) lanes[i] += lanes[i + 2];
  EXPECT_EQ(sums.total()[0], lanes[0] + lanes[1]);
}

}  // namespace
}  // namespace sulcus
