#include "engine/core/realtime.hpp"

#include <cerrno>
#include <cstring>

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

namespace sulcus {

namespace {

constexpr int kPriority = 80;  // above ordinary work, below the kernel's own threads

long cores() { return sysconf(_SC_NPROCESSORS_ONLN); }

std::uint64_t read_clock(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000u +
         static_cast<std::uint64_t>(t.tv_nsec);
}

bool pin_to(long first, long count) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (long core = first; core < first + count; ++core) CPU_SET(static_cast<size_t>(core), &set);
  return pthread_setaffinity_np(pthread_self(), sizeof(set), &set) == 0;
}

}  // namespace

std::vector<std::string> request_realtime() {
  std::vector<std::string> refused;
  sched_param priority{};
  priority.sched_priority = kPriority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority)) {
    refused.push_back(std::string("SCHED_FIFO: ") + std::strerror(error));
  }
  if (cores() < 2) {
    refused.push_back("a core of its own: there is one core");
  } else if (!pin_to(cores() - 1, 1)) {
    refused.push_back("a core of its own: not permitted");
  }
  if (mlockall(MCL_CURRENT) != 0) {
    refused.push_back(std::string("locked memory: ") + std::strerror(errno));
  }
  prctl(PR_SET_TIMERSLACK, 1);  // ns; plain threads are woken up to 50 us late otherwise
  return refused;
}

void leave_realtime_core() {
  if (cores() >= 2) pin_to(0, cores() - 1);
}

std::uint64_t steady_ns() noexcept { return read_clock(CLOCK_MONOTONIC); }
std::uint64_t thread_cpu_ns() noexcept { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

void sleep_until_ns(std::uint64_t time_ns) noexcept {
  timespec t{};
  t.tv_sec = static_cast<time_t>(time_ns / 1'000'000'000u);
  t.tv_nsec = static_cast<long>(time_ns % 1'000'000'000u);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

std::uint64_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024u;
}

}  // namespace sulcus
