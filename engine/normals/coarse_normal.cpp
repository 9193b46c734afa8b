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

}  // namespace sulcus
