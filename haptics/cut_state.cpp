#include "haptics/cut_state.hpp"

#include "engine/core/hash.hpp"

namespace sulcus {

namespace {

std::uint64_t entry_hash(std::uint32_t key, double energy_J) noexcept {
  return hash_bytes(&energy_J, sizeof(energy_J), key);
}

}  // namespace

std::size_t CutState::home(std::uint32_t key) const noexcept {
  // Fibonacci hashing: neighbouring voxels, which are cut together, spread over the table.
  return (key * std::uint64_t{0x9e3779b97f4a7c15}) >> 32 & (slots_.size() - 1);
}

std::size_t CutState::find(std::uint32_t key) const noexcept {
  std::size_t slot = home(key);
  while (slots_[slot].key != 0 && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

double CutState::energy(std::uint32_t voxel) const noexcept {
  return slots_[find(voxel + 1)].energy_J;
}

bool CutState::set_energy(std::uint32_t voxel, double energy_J) noexcept {
  const std::uint32_t key = voxel + 1;
  const std::size_t slot = find(key);
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
  }
  slots_[slot].energy_J = energy_J;
  hash_ ^= entry_hash(key, energy_J);
  return true;
}

void CutState::erase(std::size_t slot) noexcept {
  // Linear probing without tombstones: later entries of the run move up where they still are at or
  // after their home.
  const std::size_t mask = slots_.size() - 1;
  --size_;
  for (std::size_t next = (slot + 1) & mask; slots_[next].key != 0; next = (next + 1) & mask) {
    if (((next - home(slots_[next].key)) & mask) >= ((next - slot) & mask)) {
      slots_[slot] = slots_[next];
      slot = next;
    }
  }
  slots_[slot] = {};
}

}  // namespace sulcus
