#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

/// The plane through a foot, by the columns of a map of this stride; those are on it that lie no
/// more than `excess` voxels further from it, across, than quantisation leaves them.
HeightPlane plane_through(const Foot& foot, int stride, float excess) noexcept;

/// A plane over a map that is to grow, and the foot of the voxel's centre on what it has grown to.
struct PlaneGrowth {
  const HeightMap* map = nullptr;  // of any stride
  HeightPlane first;               // its slack holds until it is fitted
  int least = 0;                   // columns that must lie on it in the end
  bool fit = true;                 // to the columns on it, first of all
  std::optional<Foot> foot;
};
/// Of planes that grow together.
inline constexpr std::size_t kMostGrowths = 16;

/// The faces that planes over maps belong to, up to kMostGrowths of them side by side: one alone
/// waits for its own divisions. Each is fitted again, where `fit` says so, to all columns of its
/// map that lie on it, so that up to an edge every column of the face has a say and none beyond.
///
/// Quantisation leaves residuals spread evenly up to a bound, not in a bell: the columns that come
/// near to the bound say most, and least squares, which asks all alike, is not the best that can be
/// had. So the plane then goes a step towards the least sum of fourth powers, and one towards the
/// middle of the planes that no column contradicts (their analytic centre), within the largest
/// residual that there is.
///
/// No foot where fewer than `least` columns lie on the plane, where it is not explained by them to
/// their quantisation, or where it is steep over the columns.
void grow_planes(std::span<PlaneGrowth> growths) noexcept;

/// The same of one, from the plane through a foot.
std::optional<Foot> grow_plane(const HeightMap& map, const Foot& first, int least,
                               bool fit) noexcept;
/// What a plane through a foot is given to grow from.
HeightPlane plane_to_grow(const HeightMap& map, const Foot& first) noexcept;

}  // namespace sulcus
