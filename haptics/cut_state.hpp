#pragma once

#include <bit>
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
      : slots_(std::bit_ceil(std::uint64_t{2} * capacity)), capacity_(capacity) {}

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

  /// Of all voxels, J; walks the whole table.
  double total_energy() const;

  std::uint32_t size() const { return size_; }
  std::uint64_t hash() const { return hash_; }
  std::size_t memory_bytes() const { return slots_.capacity() * sizeof(Slot); }

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

  std::vector<Slot> slots_;
  std::uint32_t capacity_ = 0, size_ = 0;
  std::uint64_t hash_ = 0;
};

}  // namespace sulcus
