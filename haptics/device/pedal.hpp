#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>

namespace sulcus {

/// From tick `tick` on the foot pedal asks for `share` of the burr's speed, 0 to 1.
struct PedalChange {
  std::uint64_t tick = 0;
  double share = 1.0;
};

/// What it asks for in a tick; `changes` rise by tick. Before the first: all of the speed, as
/// without a pedal.
inline double pedal_at(std::span<const PedalChange> changes, std::uint64_t tick) noexcept {
  const auto after = std::ranges::upper_bound(changes, tick, {}, &PedalChange::tick);
  return after == changes.begin() ? 1.0 : std::prev(after)->share;
}

}  // namespace sulcus
