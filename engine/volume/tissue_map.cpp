#include "engine/volume/tissue_map.hpp"

#include <algorithm>
#include <optional>

namespace sulcus {

void TissueMap::set_block(std::uint32_t leaf, const LabelBlock& labels, const LeafBits& solid) {
  std::optional<std::uint8_t> first;
  bool mixed = false;
  for_each_voxel(solid, [&](int place) {
    if (!first) first = labels[place];
    mixed |= labels[place] != *first;
  });
  if (mixed) {
    mixed_[leaf] = std::make_unique<LabelBlock>(labels);
  } else {
    set_uniform(leaf, first.value_or(0));
  }
}

int TissueMap::label_count() const {
  int largest = 0;
  for (const std::uint8_t label : uniform_) largest = std::max<int>(largest, label);
  for (const auto& block : mixed_) {
    if (block) largest = std::max<int>(largest, std::ranges::max(*block));
  }
  return largest + 1;
}

std::size_t TissueMap::memory_bytes() const {
  std::size_t bytes = uniform_.capacity() + mixed_.capacity() * sizeof(mixed_[0]);
  for (const auto& block : mixed_) bytes += block ? sizeof(LabelBlock) : 0;
  return bytes;
}

}  // namespace sulcus
