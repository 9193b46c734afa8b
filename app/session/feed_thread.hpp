#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <thread>
#include <utility>

#include "app/session/feed.hpp"

namespace sulcus {

/// The first that several pieces of work throw. Of one thread at a time.
class FirstFailure {
 public:
  /// Whether `work` went through.
  template <class Work>
  bool guard(const Work& work) noexcept {
    try {
      work();
      return true;
    } catch (...) {
      if (!failure_) failure_ = std::current_exception();
      return false;
    }
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }
  /// Null: nothing was thrown.
  std::exception_ptr get() const { return failure_; }

 private:
  std::exception_ptr failure_;
};

/// A thread that consumes a feed. The last member of its owner: it ends before what it uses.
class FeedThread {
 public:
  explicit FeedThread(Feed& feed) : feed_(feed) {}
  ~FeedThread() {
    if (!thread_.joinable()) return;
    feed_.ended = true;
    thread_.join();
  }
  FeedThread(const FeedThread&) = delete;
  FeedThread& operator=(const FeedThread&) = delete;

  /// Runs `consume` on the thread. Where it throws, the feed is closed and `failed` is called
  /// there, which must not throw.
  template <class Consume>
  void start(
      Consume consume, std::function<void()> failed = [] {}) {
    thread_ = std::thread([this, consume = std::move(consume), failed = std::move(failed)] {
      if (failure_.guard(consume)) return;
      feed_.closed = true;
      failed();
    });
  }
  /// In `failed`: what was thrown.
  std::exception_ptr why() const { return failure_.get(); }
  /// After `feed.ended`: waits for the rest. Throws what ended the thread before it.
  void finish() {
    thread_.join();
    failure_.rethrow();
  }

 private:
  Feed& feed_;
  FirstFailure failure_;
  std::thread thread_;
};

/// Calls `drain` once a period, or as often as it comes to where it takes longer, until all that
/// was pushed into the feed is drained.
template <class Drain>
void drain_until_ended(const Feed& feed, std::chrono::microseconds period, const Drain& drain) {
  // `ended` is read before draining: what was pushed before it was set is still drained.
  for (bool ended = false; !ended;) {
    const auto next = std::chrono::steady_clock::now() + period;
    ended = feed.ended.load();
    drain();
    if (!ended) std::this_thread::sleep_until(next);
  }
}

}  // namespace sulcus
