#include "haptics/contacts.hpp"

#include <algorithm>

namespace sulcus {

Contacts::Contacts(std::size_t capacity) : capacity_(capacity) {
  const std::size_t room = (capacity + kGroup - 1) / kGroup * kGroup + kGroup;
  keys_ = std::make_unique_for_overwrite<std::uint32_t[]>(room);
  tissues_ = std::make_unique_for_overwrite<std::uint8_t[]>(room);
  for (auto& values : values_) values = std::make_unique_for_overwrite<float[]>(room);
}

void Contacts::resize(std::size_t size) noexcept {
  size_ = size;
  if (size == 0) passed_ = 0;
  for (std::size_t i = size; i % kGroup != 0; ++i) set(i, Contact{});
}

void Contacts::let_pass(std::size_t end) noexcept {
  if (end == passed_) return;
  for (std::size_t q = 0; passes(q); ++q) {
    // The group that is not full goes with the next ones.
    std::copy(from(q, end), from(q, (size_ + kGroup - 1) / kGroup * kGroup), values_[q].get());
  }
  passed_ = end;
}

void Contacts::push_back(const Contact& contact) noexcept {
  resize(size_ + 1);
  set(size_ - 1, contact);
}

Contact Contacts::operator[](std::size_t i) const noexcept {
  Contact c;
  c.cell = cell_of_key(keys_[i]);
  c.tissue = tissues_[i];
  if (i >= passed_) {
    c.distance_m = *from(kDistance, i);
    c.outward = vector(kOutward, i);
    c.offset_m = *from(kOffset, i);
  }
  c.normal = vector(kNormal, i);
  c.along = values_[kAlong][i];
  c.depth_m = values_[kDepth][i];
  c.weight = values_[kWeight][i];
  c.normal_force_N = values_[kForce][i];
  c.power_W = values_[kPower][i];
  return c;
}

void Contacts::set(std::size_t i, const Contact& c) noexcept {
  keys_[i] = voxel_key(c.cell);
  tissues_[i] = c.tissue;
  if (i >= passed_) {
    *from(kDistance, i) = c.distance_m;
    set_vector(kOutward, i, c.outward);
    *from(kOffset, i) = c.offset_m;
  }
  set_vector(kNormal, i, c.normal);
  values_[kAlong][i] = c.along;
  values_[kDepth][i] = c.depth_m;
  values_[kWeight][i] = c.weight;
  values_[kForce][i] = c.normal_force_N;
  values_[kPower][i] = c.power_W;
}

std::size_t Contacts::memory_bytes() const { return capacity_ * kBytesEach; }

}  // namespace sulcus
