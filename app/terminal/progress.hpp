#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace sulcus {

/// Shows on a terminal how far some work is that takes over a second, in a line that is written
/// over and goes with this; nothing where the error stream is no terminal. What is said meanwhile
/// (app/terminal/terminal.hpp) stands above it. It has a thread of its own, so that libraries need
/// not come back to us. One at a time; not beside a run at real pace.
class Progress {
 public:
  /// `what` is done: "reading".
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// How much of it, 0 to 1; seconds are shown instead where it never says. Of any thread, and as
  /// cheap as a store.
  void at(double part) noexcept { part_.store(part, std::memory_order_relaxed); }
  /// Of `whole` steps so many are done.
  void at(std::size_t done, std::size_t whole) noexcept {
    at(whole > 0 ? static_cast<double>(done) / static_cast<double>(whole) : 1.0);
  }

 private:
  void show();

  std::string what_;
  std::atomic<double> part_{-1.0};  // below 0: not said
  std::mutex mutex_;
  std::condition_variable woken_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace sulcus
