#pragma once

#include <optional>

#include "engine/graphics/camera.hpp"
#include "engine/outcome/voxel_set.hpp"
#include "engine/scene/section.hpp"

namespace sulcus {

/// Where a tooth is cut open so that a picture shows the walls of a planned cavity: through its
/// middle, to 0.01 mm, across the level axis along which the camera looks the most. None of a
/// camera that looks down into the cavity, within 30 degrees of the vertical, or that follows the
/// burr.
std::optional<Section> section_through(const VoxelSet& target, const Viewpoint& from);

/// The voxels as a body of their own.
VoxelModel model_of(const VoxelSet& voxels);

}  // namespace sulcus
