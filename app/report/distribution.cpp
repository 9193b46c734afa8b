#include "app/report/distribution.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace sulcus {

void Distribution::add(float value) noexcept {
  constexpr float kMost = std::numeric_limits<float>::max();
  const float counted = std::isfinite(value) ? std::max(value, 0.0f) : kMost;
  // The sum of -0 and 0 is 0: no sign is left among the bits.
  ++bins_[std::bit_cast<std::uint32_t>(counted + 0.0f) >> kShift];
  ++count_;
  sum_ += static_cast<double>(counted);
  largest_ = std::max(largest_, static_cast<double>(counted));
}

double Distribution::quantile(double part) const {
  if (count_ == 0) return 0.0;
  const auto rank =
      static_cast<std::uint64_t>(std::llround(part * static_cast<double>(count_ - 1)));
  if (rank + 1 == count_) return largest_;
  std::uint64_t before = 0;
  std::uint32_t bin = 0;
  while (before + bins_[bin] <= rank) before += bins_[bin++];
  if (bin == 0) return 0.0;
  const auto at = [](std::uint32_t b) {
    return static_cast<double>(std::bit_cast<float>(b << kShift));
  };
  return std::min(0.5 * (at(bin) + at(bin + 1)), largest_);
}

}  // namespace sulcus
