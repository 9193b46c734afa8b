#include "app/terminal/progress.hpp"

#include <chrono>
#include <utility>

#include <unistd.h>

#include "app/terminal/terminal.hpp"

namespace sulcus {
namespace {

constexpr std::chrono::milliseconds kFirst{1000}, kEach{200};

}  // namespace

Progress::Progress(std::string what) : what_(std::move(what)) {
  if (::isatty(STDERR_FILENO) == 1) thread_ = std::thread([this] { show(); });
}

Progress::~Progress() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  woken_.notify_one();
  thread_.join();
}

void Progress::show() {
  const auto begin = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  std::chrono::milliseconds wait = kFirst;
  while (!woken_.wait_for(lock, wait, [this] { return ended_; })) {
    wait = kEach;
    const double part = part_.load();
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    show_progress(what_ + (part >= 0.0 ? formatted(" %.0f %%", 100.0 * part)
                                       : formatted(" %.0f s", passed.count())));
  }
  show_progress("");
}

}  // namespace sulcus
