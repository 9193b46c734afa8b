#pragma once

#include <optional>

#include "engine/normals/map_kernels.hpp"

namespace sulcus {

/// c0 + c1 i + c2 j of the least squares that sums tell, in the unit of their z; none where the
/// columns are in line.
struct PlaneSolution {
  float c0, c1, c2;
};
inline std::optional<PlaneSolution> solve_plane(const PlaneSums& s) noexcept {
  // About the mean, n times the covariances.
  const float ii = s.n * s.ii - s.i * s.i, ij = s.n * s.ij - s.i * s.j, jj = s.n * s.jj - s.j * s.j;
  const float iz = s.n * s.iz - s.i * s.z, jz = s.n * s.jz - s.j * s.z;
  const float determinant = ii * jj - ij * ij;
  if (!(determinant > 0.0f)) return {};
  const float c1 = (jj * iz - ij * jz) / determinant, c2 = (ii * jz - ij * iz) / determinant;
  return PlaneSolution{(s.z - c1 * s.i - c2 * s.j) / s.n, c1, c2};
}

}  // namespace sulcus
