#include "engine/volume/packed_model.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include "engine/core/parallel.hpp"

namespace sulcus {

PackedModel pack(const VoxelModel& model) {
  PackedModel out;
  out.grid = model.grid;
  out.clipped = model.clipped;
  out.labelled = model.tissues != nullptr;
  const auto solid = static_cast<std::size_t>(
      std::ranges::count_if(model.leaves, [](const LeafBits& l) { return l != LeafBits{}; }));
  out.leaves.reserve(solid);
  out.words.reserve(solid);
  out.leaf_labels.reserve(out.labelled ? solid : 0);
  for (std::uint32_t leaf = 0; leaf < model.leaves.size(); ++leaf) {
    if (model.leaves[leaf] == LeafBits{}) continue;
    const auto row = static_cast<std::uint32_t>(out.leaves.size());
    out.leaves.push_back(leaf);
    out.words.push_back(model.leaves[leaf]);
    if (!out.labelled) continue;
    const LabelBlock* block = model.tissues->block(leaf);
    out.leaf_labels.push_back(block ? std::uint8_t{0} : model.tissues->uniform_label(leaf));
    if (block) {
      out.mixed.push_back(row);
      out.mixed_labels.push_back(*block);
    }
  }
  out.filled = model.fills.has_value();
  if (!out.filled) return out;
  const auto has_part = [](const LeafLevels& page) {
    return std::ranges::any_of(page.levels, [](FillLevel l) { return l % kFullLevel != 0; });
  };
  std::ranges::copy_if(model.fills->pages(), std::back_inserter(out.levels), has_part);
  std::ranges::sort(out.levels, {}, &LeafLevels::leaf);
  return out;
}

VoxelModel unpack(const PackedModel& packed) {
  VoxelModel model;
  model.grid = packed.grid;
  model.clipped = packed.clipped;
  model.leaves.resize(packed.grid.leaf_count());
  std::shared_ptr<TissueMap> tissues;
  if (packed.labelled) tissues = std::make_shared<TissueMap>(packed.grid.leaf_count());
  parallel_ranges<std::size_t>(
      0, packed.leaves.size(), 4096, [&](std::size_t low, std::size_t high) {
        for (std::size_t row = low; row != high; ++row) {
          model.leaves[packed.leaves[row]] = packed.words[row];
          if (tissues) tissues->set_uniform(packed.leaves[row], packed.leaf_labels[row]);
        }
      });
  parallel_ranges<std::size_t>(0, packed.mixed.size(), 256, [&](std::size_t low, std::size_t high) {
    for (std::size_t m = low; m != high; ++m) {
      const std::uint32_t row = packed.mixed[m];
      tissues->set_block(packed.leaves[row], packed.mixed_labels[m], packed.words[row]);
    }
  });
  model.tissues = std::move(tissues);
  if (packed.filled) model.fills.emplace(packed.grid.leaf_count(), packed.levels);
  return model;
}

bool is_rising_below(const std::vector<std::uint32_t>& indices, std::uint64_t end) {
  return std::ranges::adjacent_find(indices, std::greater_equal<>()) == indices.end() &&
         (indices.empty() || indices.back() < end);
}

}  // namespace sulcus
