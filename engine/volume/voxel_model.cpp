#include "engine/volume/voxel_model.hpp"

namespace sulcus {

std::uint64_t VoxelModel::solid_count() const {
  std::uint64_t count = 0;
  for (const LeafBits& leaf : leaves) count += static_cast<std::uint64_t>(count_voxels(leaf));
  return count;
}

}  // namespace sulcus
