#include "engine/core/realtime.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif
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

/// The processors that the program was given (`taskset`, a cpuset): as they were when it was first
/// asked, before any thread of ours went to one.
const cpu_set_t& given() {
  static const cpu_set_t processors = [] {
    cpu_set_t set;
    CPU_ZERO(&set);
    sched_getaffinity(0, sizeof(set), &set);
    return set;
  }();
  return processors;
}

/// The last of them; none where there are fewer than two.
std::optional<size_t> realtime_core() {
  if (CPU_COUNT(&given()) < 2) return {};
  size_t last = CPU_SETSIZE - 1;
  while (!CPU_ISSET(last, &given())) --last;
  return last;
}

std::uint64_t read_clock(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000u +
         static_cast<std::uint64_t>(t.tv_nsec);
}

bool run_on(const cpu_set_t& set) {
  return pthread_setaffinity_np(pthread_self(), sizeof(set), &set) == 0;
}

}  // namespace

std::vector<std::string> request_realtime() {
  std::vector<std::string> refused;
  sched_param priority{};
  priority.sched_priority = kPriority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority)) {
    refused.push_back(std::string("SCHED_FIFO: ") + std::strerror(error) +
                      " ('ulimit -r' says up to which priority; a line 'USER - rtprio 95' in "
                      "/etc/security/limits.conf grants it from the next login on)");
  }
  if (const std::optional<size_t> core = realtime_core()) {
    cpu_set_t own;
    CPU_ZERO(&own);
    CPU_SET(*core, &own);
    if (!run_on(own)) refused.push_back("a core of its own: not permitted");
  } else {
    refused.push_back("a core of its own: there is one core");
  }
  prctl(PR_SET_TIMERSLACK, 1);  // ns; plain threads are woken up to 50 us late otherwise
  return refused;
}

void give_back_large_blocks() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
}

std::string lock_memory() {
  if (mlockall(MCL_CURRENT) == 0) return {};
  return std::string("locked memory: ") + std::strerror(errno) + " ('ulimit -l' says how much)";
}

void leave_realtime_core() {
  const std::optional<size_t> core = realtime_core();
  if (!core) return;
  cpu_set_t others = given();
  CPU_CLR(*core, &others);
  run_on(others);
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

double process_age_s() {
  // Field 22 of the line, counted from behind the name, which may hold anything [proc(5)].
  std::ifstream stat("/proc/self/stat");
  std::string line;
  std::getline(stat, line);
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return 0.0;
  std::istringstream fields(line.substr(name_end + 1));
  std::string skipped;
  for (int field = 3; field < 22; ++field) fields >> skipped;
  double started = 0.0;  // ticks since the system came up
  if (!(fields >> started)) return 0.0;
  const double now_s = 1e-9 * static_cast<double>(read_clock(CLOCK_BOOTTIME));
  return std::max(0.0, now_s - started / static_cast<double>(sysconf(_SC_CLK_TCK)));
}

std::uint64_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024u;
}

}  // namespace sulcus
