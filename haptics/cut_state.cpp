#include "haptics/cut_state.hpp"

#include <algorithm>
#include <bit>

#include "engine/core/hash.hpp"
#include "engine/volume/grid.hpp"
#include "haptics/contact/open_addressing.hpp"

namespace sulcus {

namespace {

std::uint64_t entry_hash(std::uint32_t key, double energy_J) noexcept {
  return mix64(std::bit_cast<std::uint64_t>(energy_J) + key * 0x9e3779b97f4a7c15u);
}

}  // namespace

std::size_t CutState::home(std::uint32_t key) const noexcept {
  // Fibonacci hashing of leaves: they spread over the table, and the voxels of a leaf, which are
  // cut together, lie in a few pages, those of 2 x 2 x 2 voxels in one or two cache lines.
  const std::uint32_t in_block = (key & 1u) | (key >> 9 & 2u) | (key >> 18 & 4u);
  const std::uint32_t block = (key >> 1 & 3u) | (key >> 9 & 12u) | (key >> 17 & 48u);
  const std::uint64_t leaf = leaf_key(key) * std::uint64_t{0x9e3779b97f4a7c15} >> 32;
  return (leaf + (block << 3 | in_block)) & (slots_.size() - 1);
}

std::size_t CutState::find(std::uint32_t key) const noexcept {
  std::size_t slot = home(key);
  while (slots_[slot].key != 0 && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

double CutState::energy(std::uint32_t voxel) const noexcept {
  return slots_[find(voxel | kUsed)].energy_J;
}

double CutState::total_energy() const {
  double sum_J = 0.0;
  for_each([&](std::uint32_t, double energy_J) { sum_J += energy_J; });
  return sum_J;
}

void CutState::clear() noexcept {
  for (std::size_t word = 0; word < used_.size(); ++word) {
    for (std::uint64_t left = used_[word]; left != 0; left &= left - 1) {
      slots_[64 * word + static_cast<std::size_t>(std::countr_zero(left))] = {};
    }
  }
  std::ranges::fill(used_, 0u);
  size_ = 0;
  hash_ = 0;
}

void CutState::mark(std::size_t slot, bool used) noexcept {
  const std::uint64_t bit = std::uint64_t{1} << (slot & 63);
  std::uint64_t& word = used_[slot >> 6];
  word = used ? word | bit : word & ~bit;
}

bool CutState::set_energy(std::uint32_t voxel, double energy_J) noexcept {
  return set_at(find(voxel | kUsed), voxel | kUsed, energy_J);
}

CutState::Spent CutState::add_energy(std::uint32_t voxel, double energy_J,
                                     double needed_J) noexcept {
  const std::size_t slot = find(voxel | kUsed);
  const double stored_J = slots_[slot].energy_J + energy_J;
  if (stored_J < needed_J) return {false, set_at(slot, voxel | kUsed, stored_J) ? 0.0 : energy_J};
  set_at(slot, voxel | kUsed, 0.0);
  return {true, stored_J - needed_J};
}

bool CutState::set_at(std::size_t slot, std::uint32_t key, double energy_J) noexcept {
  if (slots_[slot].key != 0) {
    hash_ ^= entry_hash(key, slots_[slot].energy_J);
    if (energy_J == 0.0) {
      erase(slot);
      return true;
    }
  } else {
    if (energy_J == 0.0) return true;
    if (size_ == capacity_) return false;
    ++size_;
    slots_[slot].key = key;
    mark(slot, true);
  }
  slots_[slot].energy_J = energy_J;
  hash_ ^= entry_hash(key, energy_J);
  return true;
}

void CutState::erase(std::size_t slot) noexcept {
  --size_;
  close_gap(
      slot, slots_.size(), [&](std::size_t at) { return slots_[at].key != 0; },
      [&](std::size_t at) { return home(slots_[at].key); },
      [&](std::size_t to, std::size_t from) {
        slots_[to] = from == kNoSlot ? Slot{} : slots_[from];
        mark(to, from != kNoSlot);
      });
}

}  // namespace sulcus
