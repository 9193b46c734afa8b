#include "engine/normals/tool_say.hpp"

#include <algorithm>
#include <array>

#include "engine/normals/coarse_normal.hpp"
#include "engine/normals/map_group.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

void drop_unheard(const Workpiece& workpiece, std::vector<VoxelQuery>& queries,
                  std::vector<std::uint32_t>& places) noexcept {
  constexpr std::size_t kBatch = 64;
  std::array<ColumnBits::Windows, kBatch> rows;
  std::array<std::array<std::int32_t, 3>, kBatch> sums;
  std::size_t left = 0;
  for (std::size_t first = 0; first < queries.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, queries.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      rows[k] = coarse_rows(workpiece, queries[first + k].voxel);
    }
    map_kernels().coarse(rows.data(), count, sums.data());
    for (std::size_t k = 0; k < count; ++k) {
      const VoxelQuery& query = queries[first + k];
      if (heard(query.outward, coarse_of(sums[k])) == Eigen::Vector3f::Zero()) continue;
      places[left] = places[first + k];
      queries[left++] = query;
    }
  }
  queries.resize(left);
  places.resize(left);
}

}  // namespace sulcus
