#include "haptics/contacts.hpp"

namespace sulcus {

Contacts::Contacts(std::size_t capacity) : capacity_(capacity) {
  const std::size_t room = (capacity + kGroup - 1) / kGroup * kGroup + kGroup;
  keys_ = std::make_unique_for_overwrite<std::uint32_t[]>(room);
  tissues_ = std::make_unique_for_overwrite<std::uint8_t[]>(room);
  for (auto& values : values_) values = std::make_unique_for_overwrite<float[]>(room);
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
  c.distance_m = values_[kDistance][i];
  c.outward = vector(kOutward, i);
  c.normal = vector(kNormal, i);
  c.offset_m = values_[kOffset][i];
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
  values_[kDistance][i] = c.distance_m;
  set_vector(kOutward, i, c.outward);
  set_vector(kNormal, i, c.normal);
  values_[kOffset][i] = c.offset_m;
  values_[kAlong][i] = c.along;
  values_[kDepth][i] = c.depth_m;
  values_[kWeight][i] = c.weight;
  values_[kForce][i] = c.normal_force_N;
  values_[kPower][i] = c.power_W;
}

std::size_t Contacts::memory_bytes() const { return capacity_ * kBytesEach; }

}  // namespace sulcus
