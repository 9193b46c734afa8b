#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

/// c0 + c1 i + c2 j of the least squares over sums, in the unit of their z; none where the
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
  return PlaneSolution{(s.z - (c1 * s.i + c2 * s.j)) / s.n, c1, c2};
}

/// The plane through a closest point, by the columns of a map of this stride; those are on it that
/// lie no more than `excess` voxels further from it, across, than quantisation leaves them.
HeightPlane plane_through(const ClosestPoint& closest, int stride, float excess) noexcept;

/// What a plane that grows does first of all.
enum class PlaneStart : std::uint8_t {
  kFit,     // least squares over the columns on it
  kAsGiven  // nothing
};

/// A plane over a map that is to grow, and the closest point to the voxel's centre on what it has
/// grown to.
struct PlaneGrowth {
  const HeightMap* map = nullptr;  // of any stride
  HeightPlane first;               // its slack holds until it is fitted
  int least = 0;                   // columns that must lie on it in the end
  PlaneStart start = PlaneStart::kFit;
  std::optional<ClosestPoint> closest;
};
/// Of planes that grow together.
inline constexpr std::size_t kMostGrowths = 16;

/// The faces that planes over maps belong to, up to kMostGrowths of them side by side: one alone
/// waits for its own divisions. Each is fitted again, with PlaneStart::kFit, to all columns of its
/// map that lie on it, so that up to an edge every column of the face has a say and none beyond.
///
/// Quantisation leaves residuals spread evenly up to a bound, not in a bell: the columns that come
/// near to the bound say most, and least squares, which asks all alike, is not the best that can be
/// had. So the plane then goes a step towards the least sum of fourth powers, and one towards the
/// middle of the planes that no column contradicts (their analytic centre), within the largest
/// residual that there is.
///
/// No closest point where fewer than `least` columns lie on the plane, where it is not explained by
/// them to their quantisation, or where it is steep over the columns.
void grow_planes(std::span<PlaneGrowth> growths) noexcept;

/// The same of one, from the plane through a closest point.
std::optional<ClosestPoint> grow_plane(const HeightMap& map, const ClosestPoint& first, int least,
                                       PlaneStart start) noexcept;
/// What a plane through a closest point is given to grow from.
HeightPlane plane_to_grow(const HeightMap& map, const ClosestPoint& first) noexcept;

}  // namespace sulcus
