#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include <Eigen/Core>

#include "engine/volume/grid.hpp"

namespace sulcus {

/// A surface voxel that the burr may touch, and what the stages find out about it.
struct Contact {
  // [narrow_phase] Distance and outward direction pass, as the offset does: zero once they have.
  Cell cell = Cell::Zero();
  std::uint8_t tissue = 0;  // label
  float distance_m = 0.0f;  // of the voxel's centre to the burr, negative inside
  Eigen::Vector3f outward = Eigen::Vector3f::Zero();  // minus the burr's gradient there, world
  // [normals]
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit, out of the tooth; zero: none
  float offset_m = 0.0f;  // of the surface from the voxel's centre along the normal
  // [contact_force]
  float along = 0.0f;    // voxels from the centre along the normal to where depth is measured
  float depth_m = 0.0f;  // there, positive inside the burr
  float weight = 0.0f;   // 0: dropped
  float normal_force_N = 0.0f;  // |F_n|, after scaling
  float power_W = 0.0f;         // beta |F_n| |v_t|; 0 without cutting

  std::uint32_t key() const { return voxel_key(cell); }
};

/// The contacts of a tick, quantity by quantity, so that the kernels take many at a time. The
/// arrays hold whole groups, and one more beyond the capacity: after `resize` what lies beyond the
/// last contact is zero.
///
/// The first quantities pass: once `let_pass` has been told that they are done with, those of later
/// contacts take their room, so that they stay in the caches however many contacts there are.
class Contacts {
 public:
  enum Quantity : std::size_t {
    kDistance,
    kOutward,
    kOffset = kOutward + 3,
    kNormal,
    kAlong = kNormal + 3,
    kDepth,
    kWeight,
    kTurnTo,  // the tool's outward direction where depth is measured, unit; only over edges
    kForce = kTurnTo + 3,
    kPower,
    kQuantities
  };
  static constexpr bool passes(std::size_t quantity) { return quantity <= kOffset; }

  static constexpr std::size_t kGroup = 16;  // what the widest kernels take at a time
  static constexpr std::size_t kBytesEach =
      sizeof(std::uint32_t) + sizeof(std::uint8_t) + kQuantities * sizeof(float);

  /// Room for so many; memory is taken here and nowhere else.
  explicit Contacts(std::size_t capacity);

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  void clear() { size_ = passed_ = 0; }
  /// Keeps the first `size` and clears the rest of their last group.
  void resize(std::size_t size) noexcept;
  /// Up to the capacity.
  void push_back(const Contact& contact) noexcept;
  /// What passes is no longer wanted of contacts before `end`, a whole number of groups.
  void let_pass(std::size_t end) noexcept;
  std::size_t passed() const { return passed_; }

  Contact operator[](std::size_t i) const noexcept;
  void set(std::size_t i, const Contact& contact) noexcept;

  /// voxel_key of each.
  std::uint32_t* keys() { return keys_.get(); }
  const std::uint32_t* keys() const { return keys_.get(); }
  std::uint8_t* tissues() { return tissues_.get(); }
  const std::uint8_t* tissues() const { return tissues_.get(); }
  /// From contact `i` on, of which it must not have passed.
  float* from(std::size_t quantity, std::size_t i) {
    return values_[quantity].get() + (passes(quantity) ? i - passed_ : i);
  }
  const float* from(std::size_t quantity, std::size_t i) const {
    return values_[quantity].get() + (passes(quantity) ? i - passed_ : i);
  }
  /// From the first contact on; null where that has passed.
  const float* operator()(Quantity q) const {
    return passes(q) && passed_ > 0 ? nullptr : values_[q].get();
  }
  Eigen::Vector3f vector(Quantity q, std::size_t i) const {
    return {*from(q, i), *from(q + 1, i), *from(q + 2, i)};
  }
  void set_vector(Quantity q, std::size_t i, const Eigen::Vector3f& v) {
    for (std::size_t a = 0; a < 3; ++a) *from(q + a, i) = v[static_cast<int>(a)];
  }

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

  std::size_t memory_bytes() const;

 private:
  std::size_t size_ = 0, capacity_ = 0;
  std::size_t passed_ = 0;  // contacts
  // Untouched, and so no memory, until they are used.
  std::unique_ptr<std::uint32_t[]> keys_;
  std::unique_ptr<std::uint8_t[]> tissues_;
  std::array<std::unique_ptr<float[]>, kQuantities> values_;
};

}  // namespace sulcus
