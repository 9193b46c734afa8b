#include "engine/volume/tissue_map.hpp"

#include <algorithm>
#include <optional>

namespace sulcus {

TissueMap::~TissueMap() {
  for (const MixedLeaf& leaf : mixed_) delete leaf.labels;
}

void TissueMap::set_uniform(std::uint32_t leaf, std::uint8_t label) {
  uniform_[leaf] = label;
  // Written only where there is one, so that the page of others takes no memory.
  if (LabelBlock*& block = mixed_[leaf].labels) {
    delete block;
    block = nullptr;
  }
}

void TissueMap::set_block(std::uint32_t leaf, const LabelBlock& labels, const LeafBits& solid) {
  std::optional<std::uint8_t> first;
  bool mixed = false;
  for_each_voxel(solid, [&](int place) {
    if (!first) first = labels[place];
    mixed |= labels[place] != *first;
  });
  if (mixed) {
    LabelBlock*& block = mixed_[leaf].labels;
    if (block) {
      *block = labels;
    } else {
      block = new LabelBlock(labels);
    }
  } else {
    set_uniform(leaf, first.value_or(0));
  }
}

int TissueMap::label_count() const {
  int largest = 0;
  for (const std::uint8_t label : uniform_) largest = std::max<int>(largest, label);
  for (const MixedLeaf& leaf : mixed_) {
    if (leaf.labels) largest = std::max<int>(largest, std::ranges::max(*leaf.labels));
  }
  return largest + 1;
}

std::size_t TissueMap::memory_bytes() const {
  constexpr std::size_t kPage = 4096 / sizeof(MixedLeaf);
  std::size_t bytes = uniform_.capacity();
  for (std::size_t leaf = 0, end = 0; leaf < mixed_.size(); leaf = end) {
    end = std::min(leaf + kPage, mixed_.size());
    const auto blocks = std::count_if(mixed_.begin() + leaf, mixed_.begin() + end,
                                      [](const MixedLeaf& of) { return of.labels != nullptr; });
    if (blocks > 0) bytes += (end - leaf) * sizeof(MixedLeaf);
    bytes += static_cast<std::size_t>(blocks) * sizeof(LabelBlock);
  }
  return bytes;
}

}  // namespace sulcus
