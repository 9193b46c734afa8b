#pragma once

#include <cstddef>

namespace sulcus {

inline constexpr std::size_t kNoSlot = ~std::size_t{0};

/// Frees a slot of a table of 2^n slots with linear probing, without tombstones: later entries of
/// the run move up where they still are at or after their home. `taken(slot)`, `home(slot)` of a
/// taken one, and `move(to, from)`, which empties `to` where `from` is kNoSlot.
template <class Taken, class Home, class Move>
void close_gap(std::size_t slot, std::size_t slots, const Taken& taken, const Home& home,
               const Move& move) noexcept {
  const std::size_t mask = slots - 1;
  for (std::size_t next = (slot + 1) & mask; taken(next); next = (next + 1) & mask) {
    if (((next - home(next)) & mask) >= ((next - slot) & mask)) {
      move(slot, next);
      slot = next;
    }
  }
  move(slot, kNoSlot);
}

}  // namespace sulcus
