#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/graphics/geometry_image.hpp"
#include "engine/graphics/gl_scene.hpp"

namespace sulcus {

inline constexpr std::uint32_t kNoVoxel = ~std::uint32_t{0};

/// Of each pixel the voxel (VoxelGrid::linear) of its body that it shows; kNoVoxel where it shows
/// none. That is the solid voxel in which the point lies, a hair inside the surface; the surface is
/// smoother than the voxels, so where that is empty it is the solid one whose centre is nearest, as
/// far as three cells of the mesh. A piece shows voxels that were solid at the start. `scene`: as
/// the image was drawn of it, with `pieces` as in FrameState. Runs on oneTBB.
std::vector<std::uint32_t> shown_voxels(const GlScene& scene, const GeometryImage& image,
                                        std::span<const Pose> pieces);

}  // namespace sulcus
