#pragma once

#include <cstdint>
#include <vector>

#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// A voxel model without its empty leaves, in plain arrays: what recordings and the load cache
/// write. Labels of leaves without a solid voxel are not kept: nothing can come to be there.
struct PackedModel {
  VoxelGrid grid;
  bool clipped = false;
  bool labelled = false;
  std::vector<std::uint32_t> leaves;      // those with a solid voxel, rising
  std::vector<LeafBits> words;            // their voxels
  std::vector<std::uint8_t> leaf_labels;  // their tissue, 0 for mixed ones; empty unless `labelled`
  std::vector<std::uint32_t> mixed;       // places in `leaves` of those of several tissues, rising
  std::vector<LabelBlock> mixed_labels;
  bool filled = false;             // it carries fractions
  std::vector<LeafLevels> levels;  // of the leaves with a voxel that is not full, rising
};

PackedModel pack(const VoxelModel& model);

/// Needs arrays that fit one another and the grid. Parallel (oneTBB); the result does not depend on
/// the number of threads.
VoxelModel unpack(const PackedModel& packed);

/// Rising and below `end`.
bool is_rising_below(const std::vector<std::uint32_t>& indices, std::uint64_t end);

}  // namespace sulcus
