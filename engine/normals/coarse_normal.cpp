#include "engine/normals/coarse_normal.hpp"

#include <array>
#include <cstdint>

#include "engine/normals/map_kernels.hpp"

namespace sulcus {

Eigen::Vector3i coarse_normal(const Workpiece& workpiece, const Cell& c) noexcept {
  std::array<std::int32_t, 3> sums;
  const ColumnBits::Windows rows = coarse_rows(workpiece, c);
  map_kernels().coarse(&rows, 1, &sums);
  return {-sums[0], -sums[1], -sums[2]};
}

void coarse_sums(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                 ColumnBits::Windows* rows, std::array<std::int32_t, 3>* sums) noexcept {
  for (std::size_t k = 0; k < queries.size(); ++k) {
    rows[k] = coarse_rows(workpiece, queries[k].voxel);
  }
  map_kernels().coarse(rows, queries.size(), sums);
}

}  // namespace sulcus
