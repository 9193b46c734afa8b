#include "engine/volume/fill_map.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace sulcus {

std::vector<LeafLevels> joined(std::span<const std::vector<LeafLevels>> parts) {
  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  std::vector<LeafLevels> all;
  all.reserve(count);
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

FillMap::FillMap(std::uint32_t leaf_count, std::vector<LeafLevels> pages)
    : page_of_leaf_(leaf_count, kNoPage), pages_(std::move(pages)) {
  std::ranges::sort(pages_, {}, &LeafLevels::leaf);
  for (std::uint32_t at = 0; at < pages_.size(); ++at) page_of_leaf_[pages_[at].leaf] = at;
}

void FillMap::reserve(std::uint32_t more) { pages_.reserve(pages_.size() + more); }

void FillMap::set(std::uint32_t leaf, int place, FillLevel level, const LeafBits& solid) noexcept {
  std::uint32_t& at = page_of_leaf_[leaf];
  if (at == kNoPage) {
    if (level == kFullLevel) return;
    assert(has_room());
    at = static_cast<std::uint32_t>(pages_.size());
    LeafLevels& page = pages_.emplace_back();
    page.leaf = leaf;
    for_each_voxel(solid, [&](int p) { page.levels[static_cast<std::size_t>(p)] = kFullLevel; });
  }
  pages_[at].levels[static_cast<std::size_t>(place)] = level;
}

}  // namespace sulcus
