#pragma once

#include "haptics/contact/contact.hpp"
#include "haptics/device/output_limiter.hpp"

namespace sulcus {

/// How a device loses its force when the ticks end, however they end: in a straight line to zero,
/// in 50 ms, or in as much longer as the steps of the limits need. One call a tick's time.
class ForceFade {
 public:
  /// `held`: what it was sent last. That which is not finite counts as nothing.
  ForceFade(const Wrench& held, const OutputLimits& limits) noexcept;

  /// Whether there is anything left to take off.
  bool is_over() const noexcept { return left_ == 0; }
  /// What to send next; zero at the end and ever after.
  Wrench next() noexcept;

 private:
  Wrench step_;
  int left_ = 0;  // steps
};

}  // namespace sulcus
