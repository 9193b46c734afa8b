#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sulcus {

/// Asks the system to let the calling thread run on time: SCHED_FIFO, a core of its own (the last
/// of those that the program was given, where they are two or more), exact timers. Returns what it
/// was refused, one line each; empty: all granted. Never fails.
std::vector<std::string> request_realtime();

/// From here on what is freed of a MiB and more goes back to the system at once, where the C
/// library would keep it for later: loading frees tens of MiB that a run never needs again.
void give_back_large_blocks();

/// Locks what memory the process has, so that no tick waits for a page; takes some 10 ms. Returns
/// the line of what was refused, empty: granted. Never fails.
std::string lock_memory();

/// Keeps the calling thread off the core that request_realtime takes, on the others that the
/// program was given; nothing on one core.
void leave_realtime_core();

/// Nanoseconds of the steady clock.
std::uint64_t steady_ns() noexcept;
/// Seconds of the steady clock since a time of `steady_ns`.
inline double seconds_since(std::uint64_t begin_ns) noexcept {
  return 1e-9 * static_cast<double>(steady_ns() - begin_ns);
}
/// Nanoseconds of processor time of the calling thread.
std::uint64_t thread_cpu_ns() noexcept;
/// Sleeps until a time of the steady clock, in nanoseconds.
void sleep_until_ns(std::uint64_t time_ns) noexcept;

/// Seconds since the process was started, to the system's hundredth; 0 where it does not say.
double process_age_s();
/// Largest resident memory of the process so far, bytes.
std::uint64_t peak_resident_bytes();

}  // namespace sulcus
