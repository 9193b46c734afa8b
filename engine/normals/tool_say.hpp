#pragma once

#include <cstdint>
#include <vector>

#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Drops the queries of which the tool has nothing to say: what is found of their voxels is the
/// same with and without it. Those are the voxels on the far side of a wall (`heard`). `places` has
/// an entry for each query. Order is kept. No allocation.
void drop_unheard(const Workpiece& workpiece, std::vector<VoxelQuery>& queries,
                  std::vector<std::uint32_t>& places) noexcept;

}  // namespace sulcus
