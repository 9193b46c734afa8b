#include "engine/volume/tissue_map.hpp"

#include <algorithm>
#include <bit>

namespace sulcus {

void TissueMap::set_block(std::uint32_t leaf, const LabelBlock& labels,
                          const std::array<std::uint64_t, 8>& solid_words) {
  int first = -1;
  for (int k = 0; k < 8; ++k) {
    for (std::uint64_t rest = solid_words[k]; rest != 0; rest &= rest - 1) {
      const int label = labels[std::countr_zero(rest) | k << 6];
      if (first < 0) first = label;
      if (label != first) {
        mixed_[leaf] = std::make_unique<LabelBlock>(labels);
        return;
      }
    }
  }
  set_uniform(leaf, first < 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(first));
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
