#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/tilted_fit.hpp"

namespace sulcus {

/// What a small ball about a voxel shows.
enum class VoxelPlace : std::uint8_t {
  kInsideFace,  // it lies in one face
  kAnywhere
};

/// A face on one side of the voxel.
struct HalfDisc {
  ClosestPoint closest;  // of the voxel's centre on what it has grown to, map space
  float score = 0.0f;    // less is better
};

/// Near an edge, the face that a voxel belongs to: of the planes through eight half-discs of 6.8
/// voxels, 45 degrees apart, which explain their points to the quantisation, the one that passes
/// nearest to the voxel, more points breaking near ties. A plane is fitted again to what lies on
/// it, and grows over the map (grow_plane). `coarse`, unit, map space, is the coarse normal: no
/// face of an edge or corner of 50 degrees or more is further than 65 degrees from it. Nor does the
/// face point away from `outward`, map space, what the tool knows; zero where that is nothing.
/// Where no half-disc is plane, as on the walls of a narrow hole, it is what explains the part of a
/// ball on one side (TiltedFitter). Of a voxel that is kInsideFace, that
/// comes first, from just behind it on. None where none does, or `outward` leaves none of its kind.
std::optional<HalfDisc> nearest_half_disc(const HeightMap& map, const Eigen::Vector3f& coarse,
                                          const Eigen::Vector3f& outward, VoxelPlace place,
                                          TiltedFitter& fitter) noexcept;

}  // namespace sulcus
