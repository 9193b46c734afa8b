#pragma once

#include <span>
#include <string>

#include <Eigen/Geometry>

#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Writes the surface of each of a model's tissues (tissue_surfaces), moved by `space_from_world`,
/// beside `file`, "cut.stl":
/// "cut_enamel.stl" and so on, and says so on the standard output; none of a tissue with no voxel
/// left. What no file's name may hold in a tissue's becomes "_", and a name that is taken gets its
/// number. Errors as write_mesh.
void write_tissue_meshes(const std::string& file, const VoxelModel& model,
                         std::span<const TissueSettings> tissues,
                         const Eigen::Affine3d& space_from_world);

}  // namespace sulcus
