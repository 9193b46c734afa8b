#include "engine/core/realtime.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace sulcus::realtime_test {
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

bool says_why(const std::string& line, const std::string& of_what) {
  return line.starts_with(of_what + ": ") && line.size() > of_what.size() + 2 &&
         line.find('\n') == std::string::npos;
}

/// Of a process of its own, which has neither rights nor limits that grant anything. 0: each
/// refusal is a line that says of what, and why.
int what_is_wrong_with_refusals() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_RTPRIO, &none);
  setrlimit(RLIMIT_MEMLOCK, &none);
  constexpr uid_t kNobody = 65534;
  if (geteuid() == 0 && setuid(kNobody) != 0) return 1;
  const std::vector<std::string> refused = request_realtime();
  if (refused.empty() || refused.size() > 2) return 2;
  if (!says_why(refused.front(), "SCHED_FIFO")) return 3;
  if (refused.size() == 2 && !says_why(refused.back(), "a core of its own")) return 4;
#ifdef SULCUS_SANITIZED
  return 0;  // a sanitizer's mlockall does nothing, and says that it did
#else
  return says_why(lock_memory(), "locked memory") ? 0 : 5;
#endif
}

TEST(RealtimeDeathTest, EveryRefusalIsALineThatSaysOfWhat) {
  EXPECT_EXIT(std::_Exit(what_is_wrong_with_refusals()), testing::ExitedWithCode(0), "");
}

TEST(Realtime, WhatIsNotRefusedIsGranted) {
  // A thread of its own: what it is granted ends with it.
  std::thread([] {
    const std::vector<std::string> refused = request_realtime();
    const auto is_refused = [&](const std::string& what) {
      return std::ranges::any_of(refused, [&](const auto& line) { return line.starts_with(what); });
    };
    int policy = 0;
    sched_param priority{};
    ASSERT_EQ(pthread_getschedparam(pthread_self(), &policy, &priority), 0);
    EXPECT_EQ(policy == SCHED_FIFO, !is_refused("SCHED_FIFO"));
    cpu_set_t set;
    ASSERT_EQ(pthread_getaffinity_np(pthread_self(), sizeof set, &set), 0);
    EXPECT_TRUE(is_refused("a core of its own") || CPU_COUNT(&set) == 1);
  }).join();
}

std::vector<std::size_t> processors_of(const cpu_set_t& set) {
  std::vector<std::size_t> numbers;
  for (std::size_t n = 0; n < CPU_SETSIZE; ++n) {
    if (CPU_ISSET(n, &set)) numbers.push_back(n);
  }
  return numbers;
}

cpu_set_t own_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof(set), &set);
  return set;
}

/// Of a process of its own that was given one processor: 0 where both kinds of threads keep to it.
[[noreturn]] void exit_by_what_one_processor_gives(std::size_t number) {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(number, &one);
  if (sched_setaffinity(0, sizeof(one), &one) != 0) std::_Exit(10);
  std::vector<std::string> refused;
  bool kept = true;
  const auto look = [&] { kept = kept && processors_of(own_processors()) == std::vector{number}; };
  std::thread([&] {
    refused = request_realtime();
    look();
  }).join();
  std::thread([&] {
    leave_realtime_core();
    look();
  }).join();
  const bool said =
      std::ranges::find(refused, "a core of its own: there is one core") != refused.end();
  std::_Exit((kept ? 0 : 1) + (said ? 0 : 2));
}

TEST(RealtimeDeathTest, KeepsToTheProcessorsThatItWasGiven) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // anew: nobody has asked before
  const std::vector<std::size_t> all = processors_of(own_processors());
  ASSERT_FALSE(all.empty());
  EXPECT_EXIT(exit_by_what_one_processor_gives(all.front()), ::testing::ExitedWithCode(0), "");
}

TEST(Realtime, TheCoreIsTheLastOfThoseGivenAndTheOtherThreadsLeaveIt) {
  const std::vector<std::size_t> all = processors_of(own_processors());
  if (all.size() < 2) GTEST_SKIP() << "one processor";
  std::vector<std::size_t> realtime, others;
  std::vector<std::string> refused;
  std::thread([&] {
    refused = request_realtime();
    realtime = processors_of(own_processors());
  }).join();
  std::thread([&] {
    leave_realtime_core();
    others = processors_of(own_processors());
  }).join();
  EXPECT_EQ(realtime, std::vector{all.back()});
  EXPECT_EQ(others, std::vector(all.begin(), all.end() - 1));
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
}  // namespace sulcus::realtime_test
