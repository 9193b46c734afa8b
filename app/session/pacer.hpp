#pragma once

#include <cmath>
#include <cstdint>

#include "engine/core/realtime.hpp"

namespace sulcus {

/// Wakes at absolute times, one period apart. A wake that is late by whole periods moves the
/// schedule: nothing is run twice as fast and no tick is left out. Of one thread.
class Pacer {
 public:
  explicit Pacer(double rate_hz)
      : period_ns_(static_cast<std::uint64_t>(std::llround(1e9 / rate_hz))) {}

  /// Sleeps until the next tick is due; returns the microseconds that it is late. A core that has
  /// slept has cold caches: it wakes a little earlier and calls `warm_caches`.
  template <class WarmCaches>
  float wait(const WarmCaches& warm_caches) {
    if (next_ns_ == 0) next_ns_ = steady_ns();
    const std::uint64_t lead_ns = period_ns_ / 3;
    if (steady_ns() + lead_ns < next_ns_) {
      sleep_until_ns(next_ns_ - lead_ns);
      if (steady_ns() + lead_ns / 2 < next_ns_) warm_caches();
    }
    sleep_until_ns(next_ns_);
    const std::uint64_t late_ns = steady_ns() - next_ns_;
    const std::uint64_t missed = late_ns / period_ns_;
    missed_ += missed;
    next_ns_ += (missed + 1) * period_ns_;
    return static_cast<float>(1e-3 * static_cast<double>(late_ns));
  }
  /// After a pause the next tick is due at once.
  void restart() { next_ns_ = 0; }
  /// Whole periods that late wakes cost.
  std::uint64_t missed() const { return missed_; }

 private:
  std::uint64_t period_ns_, next_ns_ = 0, missed_ = 0;
};

}  // namespace sulcus
