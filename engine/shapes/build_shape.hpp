#pragma once

#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The voxels of a scene whose workpiece is a built-in shape (`scene.workpiece.shape` is set).
/// Tissues the scene does not name are not modelled: a part of the molar without a tissue of its
/// own is of the one around it (caries of dentine, pulp of dentine, dentine of enamel, enamel of
/// the first), and a scene with one tissue gets no labels. InputError as the shapes. Runs on
/// oneTBB.
VoxelModel build_shape(const Scene& scene);

}  // namespace sulcus
