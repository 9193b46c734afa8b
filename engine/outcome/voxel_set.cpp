#include "engine/outcome/voxel_set.hpp"

namespace sulcus {

namespace {

/// Solid voxels of one leaf that are of a tissue.
LeafBits leaf_of_tissue(const VoxelModel& model, std::uint32_t leaf, std::uint8_t label) {
  const LeafBits& solid = model.leaves[leaf];
  const LabelBlock* labels = model.tissues ? model.tissues->block(leaf) : nullptr;
  if (!labels) {
    const std::uint8_t all = model.tissues ? model.tissues->uniform_label(leaf) : std::uint8_t{0};
    return all == label ? solid : LeafBits{};
  }
  LeafBits voxels;
  for_each_voxel(solid, [&](int place) {
    if ((*labels)[place] == label) voxels.set(place);
  });
  return voxels;
}

}  // namespace

bool VoxelSet::insert(const Cell& c) {
  LeafBits& voxels = block(grid_.leaf_of(c));
  if (voxels.has(leaf_place(c))) return false;
  voxels.set(leaf_place(c));
  ++count_;
  return true;
}

void VoxelSet::insert(std::uint32_t leaf, const LeafBits& voxels) {
  if (!any(voxels)) return;
  LeafBits& own = block(leaf);
  count_ += static_cast<std::uint64_t>(count_voxels(without(voxels, own)));
  own |= voxels;
}

LeafBits& VoxelSet::block(std::uint32_t leaf) {
  if (place_[leaf] == kNone) {
    place_[leaf] = static_cast<std::uint32_t>(blocks_.size());
    leaves_.push_back(leaf);
    blocks_.emplace_back();
  }
  return blocks_[place_[leaf]];
}

std::size_t VoxelSet::memory_bytes() const {
  return (place_.capacity() + leaves_.capacity()) * sizeof(std::uint32_t) +
         blocks_.capacity() * sizeof(LeafBits);
}

VoxelSet without(const VoxelSet& a, const VoxelSet& b) {
  VoxelSet rest(a.grid());
  for (const std::uint32_t leaf : a.leaves()) {
    rest.insert(leaf, without(a.voxels(leaf), b.voxels(leaf)));
  }
  return rest;
}

VoxelSet voxels_of_tissue(const VoxelModel& model, std::uint8_t label) {
  VoxelSet voxels(model.grid);
  for (std::uint32_t leaf = 0; leaf < model.leaves.size(); ++leaf) {
    if (!any(model.leaves[leaf])) continue;
    voxels.insert(leaf, leaf_of_tissue(model, leaf, label));
  }
  return voxels;
}

double filled_volume(const VoxelSet& voxels, const VoxelModel& model) {
  if (!model.fills) return static_cast<double>(voxels.count());
  std::uint64_t levels = 0;
  for (const std::uint32_t leaf : voxels.leaves()) {
    for_each_voxel(voxels.voxels(leaf),
                   [&](int place) { levels += model.fills->level(leaf, place); });
  }
  return static_cast<double>(levels) / kFullLevel;
}

}  // namespace sulcus
