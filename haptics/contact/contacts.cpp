#include "haptics/contact/contacts.hpp"

#include <algorithm>

namespace sulcus {

Contacts::Contacts(std::size_t capacity)
    : QuantityArrays(capacity),
      capacity_(capacity),
      keys_(std::make_unique_for_overwrite<std::uint32_t[]>(room(capacity))),
      tissues_(std::make_unique_for_overwrite<std::uint8_t[]>(room(capacity))) {
  static_assert(std::tuple_size_v<decltype(values_)> == kQuantities);
}

void Contacts::resize(std::size_t size) noexcept {
  size_ = size;
  for (std::size_t i = size; i % kGroup != 0; ++i) set(i, Contact{});
}

void Contacts::push_back(const Contact& contact) noexcept {
  resize(size_ + 1);
  set(size_ - 1, contact);
}

Contact Contacts::operator[](std::size_t i) const noexcept {
  Contact c;
  c.cell = cell_of_key(keys_[i]);
  c.tissue = tissues_[i];
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
  set_vector(kNormal, i, c.normal);
  values_[kAlong][i] = c.along;
  values_[kDepth][i] = c.depth_m;
  values_[kWeight][i] = c.weight;
  values_[kForce][i] = c.normal_force_N;
  values_[kPower][i] = c.power_W;
}

void ContactBlock::release(std::size_t end) noexcept {
  static_assert(std::tuple_size_v<decltype(values_)> == kQuantities);
  if (end == first_) return;
  for (auto& values : values_) std::copy_n(values.get() + (end - first_), kGroup, values.get());
  first_ = end;
}

}  // namespace sulcus
