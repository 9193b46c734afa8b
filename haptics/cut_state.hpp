#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sulcus {

/// Energy stored in voxels that have been cut at but still stand: an open-addressing table by
/// voxel_key, sized once. Its hash is kept up change by change and does not depend on the order of
/// the changes.
class CutState {
 public:
  /// Room for `capacity` part-cut voxels.
  explicit CutState(std::uint32_t capacity)
      : slots_(std::bit_ceil(std::max(std::uint64_t{64}, std::uint64_t{2} * capacity))),
        used_(slots_.size() / 64),
        capacity_(capacity) {}

  /// Energy stored in a voxel, J.
  double energy(std::uint32_t voxel) const noexcept;
  /// Sets it; 0 forgets the voxel. False when the table is full and the voxel is new.
  bool set_energy(std::uint32_t voxel, double energy_J) noexcept;

  /// Adds energy to a voxel, up to what it needs.
  struct Spent {
    bool full = false;    // it has all that it needs, and is forgotten
    double over_J = 0.0;  // what it did not need, or had no room for
  };
  Spent add_energy(std::uint32_t voxel, double energy_J, double needed_J) noexcept;

  /// Asks for what add_energy of this voxel will read and write, some voxels ahead: where many are
  /// cut at, the table is larger than the caches.
  void prefetch(std::uint32_t voxel) const noexcept {
    __builtin_prefetch(&slots_[home(voxel | kUsed)], 1);
  }

  /// visit(voxel_key, energy_J) for every part-cut voxel, in the order of the table: its time goes
  /// with their number.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t word = 0; word < used_.size(); ++word) {
      for (std::uint64_t left = used_[word]; left != 0; left &= left - 1) {
        const Slot& slot = slots_[64 * word + static_cast<std::size_t>(std::countr_zero(left))];
        visit(slot.key & ~kUsed, slot.energy_J);
      }
    }
  }
  void clear() noexcept;

  /// Of all voxels, J; walks them all.
  double total_energy() const;

  std::uint32_t size() const { return size_; }
  std::uint32_t capacity() const { return capacity_; }
  std::uint64_t hash() const { return hash_; }
  std::size_t memory_bytes() const {
    return slots_.capacity() * sizeof(Slot) + used_.capacity() * sizeof(std::uint64_t);
  }

 private:
  struct Slot {
    std::uint32_t key = 0;  // voxel_key and kUsed; 0: free
    double energy_J = 0.0;
  };
  static constexpr std::uint32_t kUsed = 1u << 31;

  std::size_t home(std::uint32_t key) const noexcept;
  bool set_at(std::size_t slot, std::uint32_t key, double energy_J) noexcept;
  std::size_t find(std::uint32_t key) const noexcept;  // its slot, or the free one it would take
  void erase(std::size_t slot) noexcept;
  void mark(std::size_t slot, bool used) noexcept;

  std::vector<Slot> slots_;
  std::vector<std::uint64_t> used_;  // a bit for each slot, so that the table need not be walked
  std::uint32_t capacity_ = 0, size_ = 0;
  std::uint64_t hash_ = 0;
};

}  // namespace sulcus
