#pragma once

#include <cstdint>

#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What a model's solid voxels take up, in voxels: each by what of it is filled. Walks the volume.
inline double filled_voxels(const VoxelModel& model) {
  std::uint64_t levels = kFullLevel * model.solid_count();
  if (!model.fills) return static_cast<double>(levels) / kFullLevel;
  for (const LeafLevels& page : model.fills->pages()) {
    for_each_voxel(model.leaves[page.leaf], [&](int place) {
      levels -= kFullLevel - page.levels[static_cast<std::size_t>(place)];
    });
  }
  return static_cast<double>(levels) / kFullLevel;
}

}  // namespace sulcus
