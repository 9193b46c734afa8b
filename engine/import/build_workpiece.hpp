#pragma once

#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The voxels of a scene's workpiece: a built-in shape, a medical volume or a mesh, told apart by
/// the file's name. Tissues the scene does not name are not modelled: a part of the molar without a
/// tissue of its own is of the one around it (caries of dentine, pulp of dentine, dentine of
/// enamel, enamel of the first), and a scene with one tissue gets no labels. InputError as the
/// importers; also where the grid holds no solid voxel. Runs on oneTBB.
VoxelModel build_workpiece(const Scene& scene);

}  // namespace sulcus
