#pragma once

#include <optional>
#include <string>

#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// The closed surface of what a file holds, m, in the file's own space. A mesh (.stl, .obj, .ply)
/// is in mm; where its triangles face inwards they are turned round. Of a volume: solid is what is
/// at or above `solid_above`, of which the largest piece is kept, its voxels filled in part as
/// their grey values say; without it, what is not 0, of a mask or a label map of whole numbers up
/// to 255. A volume whose voxels are no cubes is resampled to the shortest of their edges.
/// `option`: what named the file, for messages.
/// @throws InputError as read_mesh, read_medical_volume and voxelise_volume; also of a mesh with
/// holes, of grey values without `solid_above`, and of more than 1024 voxels along an axis.
TriangleMesh surface_of_file(const std::string& path, std::optional<double> solid_above,
                             const std::string& option);

}  // namespace sulcus
