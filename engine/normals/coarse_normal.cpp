#include "engine/normals/coarse_normal.hpp"

#include <array>
#include <cstdint>

#include "engine/normals/map_kernels.hpp"

namespace sulcus {

Eigen::Vector3i coarse_normal(const Workpiece& workpiece, const Cell& c) noexcept {
  std::array<std::int32_t, 3> sums;
  map_kernels().coarse(workpiece.columns().around(0, c.y(), c.z(), c.x() - 2), sums);
  return {-sums[0], -sums[1], -sums[2]};
}

}  // namespace sulcus
