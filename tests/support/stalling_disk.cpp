// Loaded before a program (LD_PRELOAD): one write to a file named recording.h5 takes very long, as
// on a disk that stalls. SULCUS_STALL="AFTER,FOR": seconds since the first such write, and how
// long. SULCUS_FULL=NAME: there is no room for what is written to a file of that name.
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <thread>

#include <dlfcn.h>
#include <unistd.h>

namespace {

using Clock = std::chrono::steady_clock;

bool is_named(int file, std::string_view name) {
  std::array<char, 32> link{};
  std::array<char, 4096> path{};
  std::snprintf(link.data(), link.size(), "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link.data(), path.data(), path.size());
  return length > 0 &&
         std::string_view(path.data(), static_cast<std::size_t>(length)).ends_with(name);
}

/// Called by the one thread that writes the recording.
void stall(int file) {
  static const char* const said = std::getenv("SULCUS_STALL");
  static bool stalled = false;
  static Clock::time_point first;
  if (!said || stalled || !is_named(file, "recording.h5")) return;
  if (first == Clock::time_point{}) first = Clock::now();
  char* rest = nullptr;
  const double after_s = std::strtod(said, &rest);
  const double for_s = std::strtod(rest + 1, nullptr);
  if (std::chrono::duration<double>(Clock::now() - first).count() < after_s) return;
  stalled = true;
  std::this_thread::sleep_for(std::chrono::duration<double>(for_s));
}

bool is_full(int file) {
  static const char* const said = std::getenv("SULCUS_FULL");
  return said && is_named(file, said);
}

template <class Call>
Call next_of(const char* name) {
  return reinterpret_cast<Call>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, size_t count) {
  static const auto next = next_of<ssize_t (*)(int, const void*, size_t)>("write");
  stall(file);
  if (is_full(file)) {
    errno = ENOSPC;
    return -1;
  }
  return next(file, bytes, count);
}

ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
  static const auto next = next_of<ssize_t (*)(int, const void*, size_t, off_t)>("pwrite");
  stall(file);
  return next(file, bytes, count, at);
}

ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t at) {
  static const auto next = next_of<ssize_t (*)(int, const void*, size_t, off64_t)>("pwrite64");
  stall(file);
  return next(file, bytes, count, at);
}

}  // extern "C"
