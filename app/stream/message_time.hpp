#pragma once

#include <cmath>
#include <cstdint>

namespace sulcus {

/// A time as the header of a message has it: seconds, and 2^-32 of one.
struct MessageTime {
  std::uint32_t seconds = 0, fraction = 0;

  std::uint64_t stamp() const { return std::uint64_t{seconds} << 32 | fraction; }
};

/// `time_s`: 0 or later, to the nearest that there is.
inline MessageTime message_time(double time_s) {
  const auto stamp = static_cast<std::uint64_t>(std::llround(std::ldexp(time_s, 32)));
  return {static_cast<std::uint32_t>(stamp >> 32), static_cast<std::uint32_t>(stamp)};
}

}  // namespace sulcus
