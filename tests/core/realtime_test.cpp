#include "engine/core/realtime.hpp"

#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus {
namespace {

// How late a thread wakes depends on the machine and is never asserted.

TEST(Realtime, SleepsNoShorterThanAsked) {
  const std::uint64_t wake = steady_ns() + 3'000'000;
  sleep_until_ns(wake);
  EXPECT_GE(steady_ns(), wake);
}

TEST(Realtime, SleepUntilAPastTimeReturns) {
  sleep_until_ns(steady_ns() - 1);
  sleep_until_ns(0);
}

TEST(Realtime, ThreadTimeStandsStillAsleep) {
  const std::uint64_t cpu = thread_cpu_ns();
  sleep_until_ns(steady_ns() + 20'000'000);
  EXPECT_LT(thread_cpu_ns() - cpu, 10'000'000u);
}

TEST(Realtime, EveryRefusalIsALineThatSaysOfWhat) {
  std::vector<std::string> refused;
  // A thread of its own: what it is granted ends with it.
  std::thread([&] { refused = request_realtime(); }).join();
  EXPECT_LE(refused.size(), 2u);
  if (const std::string memory = lock_memory(); !memory.empty()) refused.push_back(memory);
  for (const std::string& line : refused) {
    EXPECT_NE(line.find(": "), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
}

TEST(Realtime, PeakMemoryHoldsWhatWasTouched) {
  const std::vector<char> touched(64u << 20, 1);
  const char* volatile kept = touched.data();  // a compiler may leave out what nobody reads
  EXPECT_GE(peak_resident_bytes(), touched.size());
  EXPECT_EQ(kept[touched.size() - 1], 1);
}

TEST(Realtime, TheAgeOfTheProcessPassesAsTimeDoes) {
  const double before_s = process_age_s();
  EXPECT_GE(before_s, 0.0);
  sleep_until_ns(steady_ns() + 50'000'000);
  const double after_s = process_age_s();
  EXPECT_GE(after_s - before_s, 0.0499);
  EXPECT_LT(after_s, 3600.0) << "not since the system came up";
}

}  // namespace
}  // namespace sulcus
