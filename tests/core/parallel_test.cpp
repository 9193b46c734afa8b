// Of the loops on threads of the standard library, which systems without oneTBB have.
#define SULCUS_STD_THREADS
#include "engine/core/parallel.hpp"

#include <atomic>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::parallel_test {
namespace {

TEST(Parallel, EveryRoundIsDoneOnce) {
  for (const int size : {1, 2, 7, 1000}) {
    std::vector<int> done(static_cast<std::size_t>(size), 0);
    parallel_for(5, 5 + size, [&](int i) { ++done[static_cast<std::size_t>(i - 5)]; });
    EXPECT_EQ(std::accumulate(done.begin(), done.end(), 0), size);
    EXPECT_EQ(*std::min_element(done.begin(), done.end()), 1);
  }
  parallel_for(3, 3, [](int) { FAIL(); });
  parallel_for(3, 2, [](int) { FAIL(); });
}

TEST(Parallel, RangesFollowOneAnotherAndAreNoLongerThanAsked) {
  std::vector<std::uint32_t> high_of(100, 0);
  parallel_ranges<std::uint32_t>(0, 100, 16, [&](std::uint32_t low, std::uint32_t high) {
    EXPECT_LE(high - low, 16u);
    high_of[low] = high;
  });
  std::uint32_t at = 0;
  while (at < 100 && high_of[at] > at) at = high_of[at];
  EXPECT_EQ(at, 100u);
}

TEST(Parallel, WhatARoundThrowsIsThrownAndTheOthersEnd) {
  std::atomic<int> running{0};
  const auto body = [&](int i) {
    ++running;
    if (i == 50) {
      --running;
      throw std::runtime_error("the fiftieth");
    }
    --running;
  };
  EXPECT_THROW(parallel_for(0, 1000, body), std::runtime_error);
  EXPECT_EQ(running, 0);
}

}  // namespace
}  // namespace sulcus::parallel_test
