#include "engine/volume/voxel_model.hpp"

#include <bit>

namespace sulcus {

std::uint64_t VoxelModel::solid_count() const {
  std::uint64_t count = 0;
  for (const LeafBits& leaf : leaves) {
    for (std::uint64_t word : leaf.words) count += std::popcount(word);
  }
  return count;
}

}  // namespace sulcus
