#include "haptics/stage_clock.hpp"

#include <gtest/gtest.h>

namespace sulcus::stage_clock_test {
namespace {

std::uint64_t now_ns = 0;

TEST(StageClock, AddsUpTheTimeOfEachStage) {
  StageClock clock([]() noexcept { return now_ns; });
  for (int i = 0; i < 3; ++i) {
    const auto timed = clock.time(Stage::kNormals);
    now_ns += 10;
  }
  now_ns += 1000;
  {
    const auto timed = clock.time(Stage::kRemoval);
    now_ns += 7;
  }
  EXPECT_EQ(clock.ns(Stage::kNormals), 30u);
  EXPECT_EQ(clock.ns(Stage::kRemoval), 7u);
  EXPECT_EQ(clock.ns(Stage::kBroadPhase), 0u);
  clock.reset();
  EXPECT_EQ(clock.ns(Stage::kNormals), 0u);
}

TEST(StageClock, WithoutATimeSourceNothingIsMeasured) {
  StageClock clock;
  { const auto timed = clock.time(Stage::kNormals); }
  EXPECT_EQ(clock.ns(Stage::kNormals), 0u);
}

}  // namespace
}  // namespace sulcus::stage_clock_test
