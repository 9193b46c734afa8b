#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include <Eigen/Core>

#include "engine/volume/grid.hpp"

namespace sulcus {

/// A surface voxel that the burr may touch, and what is known of it when the forces are.
struct Contact {
  Cell cell = Cell::Zero();                          // [narrow_phase]
  std::uint8_t tissue = 0;                           // [narrow_phase] label
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // [normals] unit, out of the tooth; zero: none
  float along = 0.0f;           // [measure] voxels along the normal to where depth is measured
  float depth_m = 0.0f;         // [measure] there, positive inside the burr
  float weight = 0.0f;          // [measure] 0: dropped
  float normal_force_N = 0.0f;  // [forces] |F_n|, after scaling
  float power_W = 0.0f;         // [forces] beta |F_n| |v_t|; 0 without cutting

  std::uint32_t key() const { return voxel_key(cell); }
};

/// Arrays of floats, one for each quantity, as the kernels take them: whole groups of lanes, and
/// one more beyond the capacity. Untouched, and so no memory, until they are used.
template <std::size_t kQuantities>
class QuantityArrays {
 public:
  static constexpr std::size_t kGroup = 16;  // what the widest kernels take at a time

  explicit QuantityArrays(std::size_t capacity) {
    for (auto& values : values_) values = std::make_unique_for_overwrite<float[]>(room(capacity));
  }
  static std::size_t room(std::size_t capacity) {
    return (capacity + kGroup - 1) / kGroup * kGroup + kGroup;
  }
  float* operator()(std::size_t quantity) { return values_[quantity].get(); }
  const float* operator()(std::size_t quantity) const { return values_[quantity].get(); }
  Eigen::Vector3f vector(std::size_t q, std::size_t i) const {
    return {values_[q][i], values_[q + 1][i], values_[q + 2][i]};
  }
  void set_vector(std::size_t q, std::size_t i, const Eigen::Vector3f& v) {
    for (std::size_t a = 0; a < 3; ++a) values_[q + a][i] = v[static_cast<int>(a)];
  }

 protected:
  /// Zeros from `size` to the end of its group.
  void pad(std::size_t size) noexcept {
    for (auto& values : values_) {
      for (std::size_t i = size; i % kGroup != 0; ++i) values[i] = 0.0f;
    }
  }
  std::array<std::unique_ptr<float[]>, kQuantities> values_;
};

/// The contacts of an evaluation, quantity by quantity, so that the kernels take many at a time.
/// After `resize` what fills up the last group is zero.
class Contacts : public QuantityArrays<11> {
 public:
  enum Quantity : std::size_t {
    kNormal,
    kAlong = kNormal + 3,
    kDepth,
    kWeight,
    kToolNormal,  // the tool's outward direction where depth is measured, unit; only over edges
    kForce = kToolNormal + 3,
    kPower,
    kQuantities
  };
  static constexpr std::size_t kBytesEach =
      sizeof(std::uint32_t) + sizeof(std::uint8_t) + kQuantities * sizeof(float);

  /// Room for so many; memory is taken here and nowhere else.
  explicit Contacts(std::size_t capacity);

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  void clear() { size_ = 0; }
  /// Keeps the first `size` and clears the rest of their last group.
  void resize(std::size_t size) noexcept;
  /// Up to the capacity.
  void push_back(const Contact& contact) noexcept;

  Contact operator[](std::size_t i) const noexcept;
  void set(std::size_t i, const Contact& contact) noexcept;

  /// voxel_key of each.
  std::uint32_t* keys() { return keys_.get(); }
  const std::uint32_t* keys() const { return keys_.get(); }
  std::uint8_t* tissues() { return tissues_.get(); }
  const std::uint8_t* tissues() const { return tissues_.get(); }

  class Iterator {
   public:
    Iterator(const Contacts& contacts, std::size_t i) : contacts_(contacts), i_(i) {}
    Contact operator*() const { return contacts_[i_]; }
    Iterator& operator++() { return ++i_, *this; }
    bool operator!=(const Iterator& other) const { return i_ != other.i_; }

   private:
    const Contacts& contacts_;
    std::size_t i_;
  };
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size_}; }

  std::size_t memory_bytes() const { return capacity_ * kBytesEach; }

 private:
  std::size_t size_ = 0, capacity_ = 0;
  std::unique_ptr<std::uint32_t[]> keys_;
  std::unique_ptr<std::uint8_t[]> tissues_;
};

/// What only the stages up to the depths read of a contact: of a block of contacts at a time, so
/// that it stays in the caches however many there are. Place i is contact `first() + i`.
class ContactBlock : public QuantityArrays<5> {
 public:
  enum Quantity : std::size_t {
    kDistance,               // of the voxel's centre to the burr, negative inside, m
    kOutward,                // minus the gradient of the burr's distance there, world
    kOffset = kOutward + 3,  // of the surface from the voxel's centre along the normal, m
    kQuantities
  };
  static constexpr std::size_t kVoxels = 4096;  // tested at a time

  ContactBlock() : QuantityArrays(kVoxels + kGroup) {}

  std::size_t first() const { return first_; }
  void clear() { first_ = 0; }
  /// Zeros behind the contacts, of which there are so many, in their last group.
  void set_end(std::size_t contacts) noexcept { pad(contacts - first_); }
  /// Done with the contacts before `end`, a whole number of groups. The group that is not full goes
  /// with the next block.
  void release(std::size_t end) noexcept;

  static std::size_t memory_bytes() { return kQuantities * room(kVoxels + kGroup) * sizeof(float); }

 private:
  std::size_t first_ = 0;
};

}  // namespace sulcus
