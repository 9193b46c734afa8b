#pragma once

#include <optional>

#include <Eigen/Core>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

/// The foot of the voxel's centre on the least-squares plane of the map's points within 3.6 voxels
/// of it; none where they are fewer than five or in line.
std::optional<Foot> close_plane(const HeightMap& map) noexcept;

/// The plane, else the quadric, that explains all points of a map of stride 1, or of a side of it,
/// within `radius` voxels of the voxel to their quantisation, fitted in the frame whose third axis
/// is `normal`: there a curved surface is a quadric farther out than over the columns. None where
/// neither does.
std::optional<Foot> fit_tilted(const HeightMap& map, const Eigen::Vector3f& normal, float radius,
                               const MapSide& side = {}) noexcept;

}  // namespace sulcus
