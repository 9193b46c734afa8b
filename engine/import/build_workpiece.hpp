#pragma once

#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The voxels of a scene's workpiece: a built-in shape (build_shape), a medical volume or a mesh,
/// told apart by the file's name. InputError as the importers; also where the grid holds no solid
/// voxel. Runs on oneTBB.
VoxelModel build_workpiece(const Scene& scene);

}  // namespace sulcus
