#pragma once

#include <optional>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

/// The plane through a foot, by the columns of a map of this stride; those are on it that lie no
/// more than `excess` voxels further from it, across, than quantisation leaves them.
HeightPlane plane_through(const Foot& foot, int stride, float excess) noexcept;

/// The face that a plane over a map belongs to: fitted again, where `fit` says so, to all columns
/// of the map that lie on it, so that up to an edge every column of the face has a say and none
/// beyond.
///
/// Quantisation leaves residuals spread evenly up to a bound, not in a bell: the columns that come
/// near to the bound say most, and least squares, which asks all alike, is not the best that can be
/// had. So the plane then goes a step towards the least sum of fourth powers, and one towards the
/// middle of the planes that no column contradicts (their analytic centre), within the largest
/// residual that there is.
///
/// Of maps of any stride. The foot of the voxel's centre on it; none where fewer than `least`
/// columns lie on the plane, where it is not explained by them to their quantisation, or where it
/// is steep over the columns.
std::optional<Foot> grow_plane(const HeightMap& map, const Foot& first, int least,
                               bool fit) noexcept;
/// The same from a plane with a slack of its own, until it is fitted.
std::optional<Foot> grow_plane(const HeightMap& map, const HeightPlane& first, int least,
                               bool fit) noexcept;

}  // namespace sulcus
